"""Trajectories and their snapshots in the database: each located snapshot and each refusal is a row."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from typing import Any, cast

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session

from app.errors import Conflict, NotFound
from app.geometry.pose import Pose
from app.storage.blobs import array_of_blob, blob_of_array
from app.storage.ids import new_id
from app.storage.models import SnapshotRow, TrajectoryRow
from app.storage.snapshots import (
    Heading,
    Located,
    Moment,
    NewSnapshot,
    NotFoundPose,
    RefusedBlob,
    Seen,
    SeenTarget,
    Snapshot,
    TimeSource,
    Trajectory,
)
from app.storage.upsert import insert_if_absent

POSE_COLUMNS = ("x_m", "y_m", "z_m", "sigma_m", "rotation", "covariance")  # null in a refusal


class TrajectoryRepository:
    """Trajectories of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def open_one(self, trajectory_id: str, site_id: str) -> Trajectory:
        """A trajectory that takes snapshots of a site.

        Raises
        ------
        NotFound
            When it does not exist.
        Conflict
            When it is closed or belongs to another site.
        """
        row = self._session.get(TrajectoryRow, trajectory_id)
        if row is None:
            raise NotFound(
                f"there is no trajectory {trajectory_id}; leave trajectory_id out to use the device's default",
                trajectory_id=trajectory_id,
            )
        if row.site_id != site_id or row.closed_s is not None:
            why = "is closed" if row.site_id == site_id else f"belongs to site {row.site_id}"
            raise Conflict(
                f"trajectory {trajectory_id} {why}; name an open one of this site or leave trajectory_id out",
                trajectory_id=trajectory_id,
            )
        return _trajectory(row)

    def default(self, site_id: str, device_id: str | None) -> Trajectory:
        """The trajectory that collects a device's snapshots of a site; made when there is none."""
        query = select(TrajectoryRow).where(TrajectoryRow.default_key == json.dumps([site_id, device_id]))
        row = self._session.scalars(query).one_or_none()
        if row is None:
            self._add_default(site_id, device_id)
            row = self._session.scalars(query).one()
        return _trajectory(row)

    def _add_default(self, site_id: str, device_id: str | None) -> None:
        """Whoever comes first makes it."""
        insert_if_absent(
            self._session,
            TrajectoryRow,
            id=new_id(),
            site_id=site_id,
            device_id=device_id,
            name="default",
            default_key=json.dumps([site_id, device_id]),
            created_s=time.time(),
            closed_s=None,
        )

    def record(self, trajectory_id: str, snapshot: NewSnapshot) -> Snapshot:
        """Add a snapshot; one whose ``snapshot_id`` the site already has is not added: the first one is returned."""
        values = _snapshot_values(new_id(), trajectory_id, snapshot)
        if insert_if_absent(self._session, SnapshotRow, **values):
            return Snapshot(values["id"], trajectory_id, snapshot.heading, snapshot.outcome, snapshot.seen)
        first = self.find(snapshot.heading.site_id, str(snapshot.heading.snapshot_id))
        assert first is not None, "only a taken snapshot_id keeps a row out"
        return first

    def find(self, site_id: str, snapshot_id: str) -> Snapshot | None:
        """The snapshot that a client gave this id, None when it has not come yet."""
        query = select(SnapshotRow).where(SnapshotRow.site_id == site_id, SnapshotRow.snapshot_id == snapshot_id)
        row = self._session.scalars(query).one_or_none()
        return None if row is None else _snapshot(row)

    def snapshots(self, trajectory_id: str, limit: int) -> tuple[Snapshot, ...]:
        """The first snapshots of a trajectory in the order of their time."""
        query = select(SnapshotRow).where(SnapshotRow.trajectory_id == trajectory_id)
        rows = self._session.scalars(query.order_by(SnapshotRow.captured_s, SnapshotRow.id).limit(limit))
        return tuple(_snapshot(row) for row in rows)


def _trajectory(row: TrajectoryRow) -> Trajectory:
    default = row.default_key is not None
    return Trajectory(row.id, row.site_id, row.device_id, row.name, default, row.created_s, row.closed_s)


def _snapshot_values(pose_id: str, trajectory_id: str, snapshot: NewSnapshot) -> dict[str, Any]:
    heading = snapshot.heading
    return {
        "id": pose_id,
        "trajectory_id": trajectory_id,
        "site_id": heading.site_id,
        "snapshot_id": heading.snapshot_id,
        "device_id": heading.device_id,
        "map_version": heading.map_version,
        "captured_s": heading.moment.captured_s,
        "received_s": heading.received_s,
        "time_source": heading.moment.source,
        "clock_delay_s": heading.moment.clock_delay_s,
        **_outcome_values(snapshot.outcome, asdict(snapshot.seen)),
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


def _snapshot(row: SnapshotRow) -> Snapshot:
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


def _outcome(row: SnapshotRow) -> Located | NotFoundPose:
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
    )
