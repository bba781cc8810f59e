"""A trajectory as a row, and back; what a snapshot changes in it."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from typing import Any

from app.errors import Conflict, NotFound
from app.storage.ids import new_id
from app.storage.snapshots import NewSnapshot, NotFoundPose
from app.storage.trajectory_parts import FileSource, StoredTrajectory

DEFAULT_NAME = "default"
COUNTED = ("snapshot_count", "failures", "first_s", "last_s")  # columns that a snapshot changes


def default_key(site_id: str, device_id: str | None) -> str:
    """What makes a device's default trajectory of a site the only one."""
    return json.dumps([site_id, device_id])


def first_values(site_id: str, device_id: str | None, name: str) -> dict[str, Any]:
    """Columns of a trajectory without snapshots."""
    return {
        "id": new_id(),
        "site_id": site_id,
        "device_id": device_id,
        "name": name,
        "created_s": time.time(),
        "closed_s": None,
        "snapshot_count": 0,
        "failures": {},
        "first_s": None,
        "last_s": None,
    }


def stored_trajectory(row: Any) -> StoredTrajectory:
    """The trajectory of a row, an object's or a query's."""
    return StoredTrajectory(
        trajectory_id=row.id,
        site_id=row.site_id,
        device_id=row.device_id,
        name=row.name,
        default=row.default_key is not None,
        created_s=row.created_s,
        closed_s=row.closed_s,
        snapshot_count=row.snapshot_count,
        removed_count=row.removed_count,
        failures=tuple(sorted(row.failures.items())),
        first_s=row.first_s,
        last_s=row.last_s,
        source=None if row.source is None else FileSource(**row.source),
        imported_count=row.imported_count,
    )


def counted_values(trajectory: StoredTrajectory) -> dict[str, Any]:
    """The columns that snapshots change."""
    counted = (trajectory.snapshot_count, dict(trajectory.failures), trajectory.first_s, trajectory.last_s)
    return dict(zip(COUNTED, counted, strict=True))


def with_snapshot(trajectory: StoredTrajectory, snapshot: NewSnapshot) -> StoredTrajectory:
    """The trajectory with one more snapshot in its totals."""
    captured_s = snapshot.heading.moment.captured_s
    failures = dict(trajectory.failures)
    if isinstance(snapshot.outcome, NotFoundPose):
        failures[snapshot.outcome.reason] = failures.get(snapshot.outcome.reason, 0) + 1
    return replace(
        trajectory,
        snapshot_count=trajectory.snapshot_count + 1,
        failures=tuple(sorted(failures.items())),
        first_s=captured_s if trajectory.first_s is None else min(trajectory.first_s, captured_s),
        last_s=captured_s if trajectory.last_s is None else max(trajectory.last_s, captured_s),
    )


def check_taking(trajectory: StoredTrajectory, site_id: str) -> None:
    """See that a trajectory takes snapshots of a site.

    Raises
    ------
    Conflict
        When it is closed or belongs to another site.
    """
    if trajectory.site_id != site_id:
        why = f"belongs to site {trajectory.site_id}"
    elif trajectory.closed_s is not None:
        why = "is closed"
    else:
        return
    raise Conflict(
        f"trajectory {trajectory.trajectory_id} {why}; name an open one of this site or leave trajectory_id out",
        trajectory_id=trajectory.trajectory_id,
    )


def taken_id(trajectory_id: str) -> Conflict:
    """The error for an id that a trajectory of another site has."""
    return Conflict(
        f"the id {trajectory_id} belongs to something else; make another one, or leave it to the server",
        trajectory_id=trajectory_id,
    )


def no_trajectory(trajectory_id: str) -> NotFound:
    """The error for a trajectory that does not exist."""
    return NotFound(
        f"there is no trajectory {trajectory_id}; GET /trajectories lists them, and a snapshot without "
        "trajectory_id goes to its device's default",
        trajectory_id=trajectory_id,
    )
