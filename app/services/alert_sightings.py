"""What an alert rests on: the snapshots that saw its target, each with where the target seemed to stand."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from sqlalchemy.orm import Session

from app.photogrammetry.evidence import SnapshotEvidence
from app.storage.alerts import Alert, AlertKind, AlertRepository
from app.storage.map_evidence import EvidenceRepository, KeptEvidence

Array = npt.NDArray[np.float64]
MOST_SIGHTINGS = 200  # the newest: what a reader can look through


@dataclass(frozen=True)
class AlertSighting:
    """A target in one snapshot.

    Attributes
    ----------
    pose_id, trajectory_id : str
    captured_s : float
        UTC.
    device_id : str or None
    camera_m : ndarray of shape (3,)
        Where the snapshot was taken, site frame.
    movement_m : ndarray of shape (3,) or None
        Of the target's centre against the map, site axes, as it looks from the snapshot's pose alone; None for a code
        that the map does not hold.
    used : bool
        Whether the target carried the pose.
    """

    pose_id: str
    trajectory_id: str
    captured_s: float
    device_id: str | None
    camera_m: Array
    movement_m: Array | None
    used: bool


def sightings_of(session: Session, alert_id: str) -> tuple[AlertSighting, ...]:
    """The snapshots between an alert's first and last that saw its target, the newest first; none for a whole map.

    Raises
    ------
    NotFound
    """
    alert = AlertRepository(session).get(alert_id)
    found: list[AlertSighting] = []
    for sighting in _seen(session, alert):
        found.append(sighting)
        if len(found) == MOST_SIGHTINGS:
            break
    return tuple(found)


def _seen(session: Session, alert: Alert) -> Iterator[AlertSighting]:
    trouble = alert.trouble
    if trouble.code is None:
        return
    span_s = trouble.since_s, trouble.last_s
    for kept in EvidenceRepository(session).between(alert.site_id, alert.map_version, span_s):
        evidence = kept.snapshot.evidence
        if evidence is not None and trouble.code in _codes_told(evidence, trouble.kind):
            yield _sighting(kept, evidence, trouble.code)


def _codes_told(evidence: SnapshotEvidence, kind: AlertKind) -> Collection[int]:
    """A code that the map lacks is told by snapshots that read it surely, others by all that show their target."""
    return evidence.unknown_codes if kind == "unknown-target" else evidence.seen_codes


def _sighting(kept: KeptEvidence, evidence: SnapshotEvidence, code: int) -> AlertSighting:
    movements = evidence.movements
    (rows,) = np.nonzero(movements.codes == code)
    return AlertSighting(
        pose_id=kept.pose_id,
        trajectory_id=kept.trajectory_id,
        captured_s=kept.snapshot.captured_s,
        device_id=kept.snapshot.device_id,
        camera_m=evidence.site_from_cam.position_m,
        movement_m=movements.values[rows[0], :3] if len(rows) else None,
        used=bool(len(rows) and movements.used[rows[0]]),
    )
