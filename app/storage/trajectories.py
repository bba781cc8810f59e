"""Trajectories in the database: opened, filled with snapshots and refusals, closed."""

from __future__ import annotations

import json
import time
from dataclasses import replace

from sqlalchemy import bindparam, select, update
from sqlalchemy.orm import Session

from app.errors import Conflict, NotFound
from app.storage.ids import new_id
from app.storage.models import SnapshotRow, TrajectoryRow
from app.storage.snapshot_rows import snapshot_of_row, values_of_snapshot
from app.storage.snapshots import NewSnapshot, NotFoundPose, Snapshot
from app.storage.trajectory_parts import StoredTrajectory
from app.storage.upsert import insert_if_absent

# Built once: for a pose row that takes longer than its execution.
DEFAULT = select(TrajectoryRow).where(TrajectoryRow.default_key == bindparam("key")).with_for_update()
COUNT = update(TrajectoryRow).where(TrajectoryRow.id == bindparam("counted_id"))
COUNT = COUNT.values({name: bindparam(name) for name in ("snapshot_count", "failures", "first_s", "last_s")})


class TrajectoryRepository:
    """Trajectories of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._locked: dict[str, StoredTrajectory] = {}  # until the transaction ends nobody else changes these

    def add(self, site_id: str, device_id: str | None, name: str) -> StoredTrajectory:
        """A new trajectory without snapshots."""
        row = TrajectoryRow(default_key=None, **_first_values(site_id, device_id, name))
        self._session.add(row)
        self._session.flush()
        return stored_trajectory(row)

    def get(self, trajectory_id: str) -> StoredTrajectory:
        """One trajectory as it stands.

        Raises
        ------
        NotFound
        """
        return stored_trajectory(self._row(trajectory_id))

    def open_one(self, trajectory_id: str, site_id: str) -> StoredTrajectory:
        """A trajectory that takes snapshots of a site.

        Raises
        ------
        NotFound
            When it does not exist.
        Conflict
            When it is closed or belongs to another site.
        """
        return _taking(self.get(trajectory_id), site_id)

    def default(self, site_id: str, device_id: str | None) -> StoredTrajectory:
        """The open trajectory that collects a device's snapshots of a site; made when there is none."""
        key = json.dumps([site_id, device_id])
        row = self._session.scalars(DEFAULT, {"key": key}).one_or_none()
        if row is None:
            values = _first_values(site_id, device_id, "default")
            insert_if_absent(self._session, TrajectoryRow, default_key=key, **values)  # whoever comes first makes it
            row = self._session.scalars(DEFAULT, {"key": key}).one()
        # Locked: nobody closes it before the snapshot is in.
        self._locked[row.id] = stored_trajectory(row)
        return self._locked[row.id]

    def close(self, trajectory_id: str) -> StoredTrajectory:
        """Take no more snapshots; a trajectory that is closed stays as it is.

        A default trajectory ceases to be one: the device's next snapshot opens another.

        Raises
        ------
        NotFound
        """
        row = self._row(trajectory_id, lock=True)
        if row.closed_s is None:
            row.closed_s, row.default_key = time.time(), None
            self._session.flush()
        self._locked[trajectory_id] = stored_trajectory(row)
        return self._locked[trajectory_id]

    def record(self, trajectory_id: str, snapshot: NewSnapshot) -> Snapshot:
        """Add a snapshot; one whose ``snapshot_id`` the site already has is not added: the first one is returned.

        The trajectory's row is locked until the transaction ends, so that ordinals appear in their order.

        Raises
        ------
        NotFound, Conflict
            When the trajectory does not exist, is closed or belongs to another site.
        """
        trajectory = _taking(self._lock(trajectory_id), snapshot.heading.site_id)
        place = {"id": new_id(), "trajectory_id": trajectory_id, "ordinal": trajectory.snapshot_count + 1}
        if insert_if_absent(self._session, SnapshotRow, **place, **values_of_snapshot(snapshot)):
            self._count(_with(trajectory, snapshot))
            return Snapshot(str(place["id"]), trajectory_id, snapshot.heading, snapshot.outcome, snapshot.seen)
        first = self.find(snapshot.heading.site_id, str(snapshot.heading.snapshot_id))
        assert first is not None, "only a taken snapshot_id keeps a row out"
        return first

    def find(self, site_id: str, snapshot_id: str) -> Snapshot | None:
        """The snapshot that a client gave this id, None when it has not come yet."""
        query = select(SnapshotRow).where(SnapshotRow.site_id == site_id, SnapshotRow.snapshot_id == snapshot_id)
        row = self._session.scalars(query).one_or_none()
        return None if row is None else snapshot_of_row(row)

    def snapshots(self, trajectory_id: str, limit: int) -> tuple[Snapshot, ...]:
        """The first snapshots of a trajectory in the order of their time, with all that they showed."""
        query = select(SnapshotRow).where(SnapshotRow.trajectory_id == trajectory_id)
        rows = self._session.scalars(query.order_by(SnapshotRow.captured_s, SnapshotRow.ordinal).limit(limit))
        return tuple(snapshot_of_row(row) for row in rows)

    def _lock(self, trajectory_id: str) -> StoredTrajectory:
        if trajectory_id not in self._locked:
            self._locked[trajectory_id] = stored_trajectory(self._row(trajectory_id, lock=True))
        return self._locked[trajectory_id]

    def _count(self, counted: StoredTrajectory) -> None:
        values = {
            "counted_id": counted.trajectory_id,
            "snapshot_count": counted.snapshot_count,
            "failures": dict(counted.failures),
            "first_s": counted.first_s,
            "last_s": counted.last_s,
        }
        self._session.connection().execute(COUNT, values)
        self._locked[counted.trajectory_id] = counted

    def _row(self, trajectory_id: str, *, lock: bool = False) -> TrajectoryRow:
        row = self._session.get(TrajectoryRow, trajectory_id, with_for_update=lock, populate_existing=True)
        if row is None:
            raise NotFound(
                f"there is no trajectory {trajectory_id}; GET /trajectories lists them, and a snapshot without "
                "trajectory_id goes to its device's default",
                trajectory_id=trajectory_id,
            )
        return row


def stored_trajectory(row: TrajectoryRow) -> StoredTrajectory:
    """The trajectory of a row."""
    return StoredTrajectory(
        trajectory_id=row.id,
        site_id=row.site_id,
        device_id=row.device_id,
        name=row.name,
        default=row.default_key is not None,
        created_s=row.created_s,
        closed_s=row.closed_s,
        snapshot_count=row.snapshot_count,
        failures=tuple(sorted(row.failures.items())),
        first_s=row.first_s,
        last_s=row.last_s,
    )


def _first_values(site_id: str, device_id: str | None, name: str) -> dict[str, object]:
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


def _with(trajectory: StoredTrajectory, snapshot: NewSnapshot) -> StoredTrajectory:
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


def _taking(trajectory: StoredTrajectory, site_id: str) -> StoredTrajectory:
    """The trajectory when it takes snapshots of the site."""
    if trajectory.site_id != site_id:
        why = f"belongs to site {trajectory.site_id}"
    elif trajectory.closed_s is not None:
        why = "is closed"
    else:
        return trajectory
    raise Conflict(
        f"trajectory {trajectory.trajectory_id} {why}; name an open one of this site or leave trajectory_id out",
        trajectory_id=trajectory.trajectory_id,
    )
