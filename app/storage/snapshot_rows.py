"""A snapshot as a row, and back."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from sqlalchemy import Row

from app.geometry.pose import Pose
from app.storage.blobs import array_of_blob, blob_of_array
from app.storage.models import SnapshotRow
from app.storage.snapshots import (
    Focal,
    Heading,
    Located,
    Moment,
    NewSnapshot,
    NotFoundPose,
    RefusedBlob,
    RollingShutter,
    Seen,
    SeenTarget,
    Snapshot,
    TimeSource,
)

POSE_COLUMNS = ("x_m", "y_m", "z_m", "sigma_m", "rotation", "covariance")  # null in a refusal


def values_of_snapshot(snapshot: NewSnapshot) -> dict[str, Any]:
    """A snapshot's columns, without its place in a trajectory."""
    heading = snapshot.heading
    return {
        "site_id": heading.site_id,
        "snapshot_id": heading.snapshot_id,
        "device_id": heading.device_id,
        "map_version": heading.map_version,
        "captured_s": heading.moment.captured_s,
        "received_s": heading.received_s,
        "time_source": heading.moment.source,
        "clock_delay_s": heading.moment.clock_delay_s,
        **_outcome_values(snapshot.outcome, _seen_values(snapshot.seen)),
    }


def values_of_evidence(snapshot: NewSnapshot) -> dict[str, Any]:
    """The columns of what a snapshot tells of its map, without the snapshot's id."""
    heading = snapshot.heading
    return {
        "site_id": heading.site_id,
        "map_version": heading.map_version,
        "captured_s": heading.moment.captured_s,
        "device_id": heading.device_id,
        "record": snapshot.evidence,
    }


def _seen_values(seen: Seen) -> dict[str, Any]:
    """As JSON takes it; ``asdict`` would copy each of some fifty items, which takes longer than writing the row."""
    return {
        "targets": [vars(target) for target in seen.targets],
        "rejected": [vars(item) for item in seen.rejected],
        "timing_ms": seen.timing_ms,
    }


def _outcome_values(outcome: Located | NotFoundPose, seen: dict[str, Any]) -> dict[str, Any]:
    if isinstance(outcome, NotFoundPose):
        told = {**seen, "detail": outcome.detail, "advice": outcome.advice}
        return {**dict.fromkeys(POSE_COLUMNS), "reason": outcome.reason, "seen": told}
    x_m, y_m, z_m = (float(value) for value in outcome.site_from_cam.position_m)
    fit = {
        "sigma0": outcome.sigma0,
        "redundancy": outcome.redundancy,
        "rms_residual_px": outcome.rms_residual_px,
        "camera_source": outcome.camera_source,
        "ambiguity_ratio": outcome.ambiguity_ratio,
        "focal": None if outcome.focal is None else vars(outcome.focal),
        "rolling_shutter": None if outcome.rolling_shutter is None else vars(outcome.rolling_shutter),
    }
    return {
        "reason": None,
        "x_m": x_m,
        "y_m": y_m,
        "z_m": z_m,
        "sigma_m": float(outcome.position_sigma_m.max()),
        "rotation": blob_of_array(outcome.site_from_cam.rotation),
        "covariance": blob_of_array(outcome.covariance),
        "seen": {**seen, **fit},
    }


def snapshot_of_row(row: SnapshotRow | Row[Any]) -> Snapshot:
    """The snapshot of a row, an object's or a query's."""
    moment = Moment(row.captured_s, cast(TimeSource, row.time_source), row.clock_delay_s)
    heading = Heading(row.site_id, row.map_version, moment, row.received_s, row.device_id, row.snapshot_id)
    seen = Seen(
        targets=tuple(SeenTarget(**target) for target in row.seen["targets"]),
        rejected=tuple(
            RefusedBlob(item["reason"], (item["centre_px"][0], item["centre_px"][1]), item["code"])
            for item in row.seen["rejected"]
        ),
        timing_ms=tuple((stage, milliseconds) for stage, milliseconds in row.seen["timing_ms"]),
    )
    return Snapshot(row.id, row.trajectory_id, heading, _outcome(row), seen)


def _outcome(row: SnapshotRow | Row[Any]) -> Located | NotFoundPose:
    if row.reason is not None or row.rotation is None or row.covariance is None:
        return NotFoundPose(str(row.reason), row.seen["detail"], row.seen["advice"])
    position_m = np.array([row.x_m, row.y_m, row.z_m], dtype=np.float64)
    return Located(
        site_from_cam=Pose(array_of_blob(row.rotation, 3, 3), position_m),
        covariance=array_of_blob(row.covariance, 6, 6),
        sigma0=row.seen["sigma0"],
        redundancy=row.seen["redundancy"],
        rms_residual_px=row.seen["rms_residual_px"],
        camera_source=row.seen["camera_source"],
        ambiguity_ratio=row.seen["ambiguity_ratio"],
        focal=_focal(row.seen.get("focal")),
        rolling_shutter=_rolling_shutter(row.seen.get("rolling_shutter")),
    )


def _focal(record: dict[str, float] | None) -> Focal | None:
    return None if record is None else Focal(**record)


def _rolling_shutter(record: dict[str, Any] | None) -> RollingShutter | None:
    if record is None:
        return None
    triples = {name: None if record[name] is None else tuple(record[name]) for name in ("motion", "motion_sigmas")}
    return RollingShutter(**{**record, **triples})
