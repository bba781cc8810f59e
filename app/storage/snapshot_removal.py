"""Snapshots are removed with their pictures; their trajectories' totals follow, and no ordinal is given twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import ColumnElement, delete, func, select
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.models import KeptSnapshotRow, SnapshotRow, TrajectoryRow
from app.storage.sites import find_site_row
from app.storage.trajectory_rows import no_trajectory

# SQLite takes 999 parameters in its oldest builds, and its other writers wait for some milliseconds.
REMOVED_AT_A_TIME = 500


@dataclass(frozen=True)
class SnapshotFilter:
    """Which snapshots of a site are wanted.

    Attributes
    ----------
    device_id : str or None
        Of one device; None: of all.
    before_s : float or None
        Captured earlier than this, UTC seconds; None: whenever.
    """

    site_id: str
    device_id: str | None = None
    before_s: float | None = None

    @property
    def conditions(self) -> list[ColumnElement[bool]]:
        """As a query has them."""
        found = [SnapshotRow.site_id == self.site_id]
        if self.device_id is not None:
            found.append(SnapshotRow.device_id == self.device_id)
        if self.before_s is not None:
            found.append(SnapshotRow.captured_s < self.before_s)
        return found


@dataclass(frozen=True)
class Removed:
    """How many snapshots were removed, and the digests of the pictures that were kept of them."""

    count: int
    pictures: tuple[str, ...]


class SnapshotRemoval:
    """Removes snapshots in one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def pose(self, pose_id: str) -> Removed:
        """Remove one snapshot, located or refused.

        Raises
        ------
        NotFound
        """
        trajectory_id = self._session.scalar(select(SnapshotRow.trajectory_id).where(SnapshotRow.id == pose_id))
        removed = None if trajectory_id is None else self._of_trajectory(trajectory_id, [SnapshotRow.id == pose_id])
        if removed is None or removed.count == 0:
            raise NotFound(f"there is no pose {pose_id}; GET /trajectories/{{id}} lists them", pose_id=pose_id)
        return removed

    def some(self, wanted: SnapshotFilter) -> Removed | None:
        """Remove some of a site's snapshots; None when there are none left.

        Raises
        ------
        NotFound
            When there is no such site.
        """
        find_site_row(self._session, wanted.site_id)
        trajectory_id = self._session.scalar(select(SnapshotRow.trajectory_id).where(*wanted.conditions).limit(1))
        return None if trajectory_id is None else self._of_trajectory(trajectory_id, wanted.conditions)

    def some_of_trajectory(self, trajectory_id: str) -> Removed:
        """Remove some of a trajectory's snapshots; none when none are left."""
        return self._of_trajectory(trajectory_id, [])

    def trajectory(self, trajectory_id: str) -> Removed:
        """Remove a trajectory with the snapshots that are left.

        Raises
        ------
        NotFound
        """
        row = self._locked(trajectory_id)
        if row is None:
            raise no_trajectory(trajectory_id)
        pictures = self._pictures([SnapshotRow.trajectory_id == trajectory_id])
        self._session.delete(row)
        self._session.flush()
        return Removed(row.snapshot_count - row.removed_count, pictures)

    def empty_trajectories(self, site_id: str, device_id: str) -> int:
        """Remove a device's trajectories that hold nothing any more; how many."""
        empty = delete(TrajectoryRow).where(
            TrajectoryRow.site_id == site_id,
            TrajectoryRow.device_id == device_id,
            TrajectoryRow.removed_count == TrajectoryRow.snapshot_count,
            TrajectoryRow.imported_count == 0,
        )
        return len(self._session.scalars(empty.returning(TrajectoryRow.id)).all())

    def _of_trajectory(self, trajectory_id: str, conditions: Sequence[ColumnElement[bool]]) -> Removed:
        """Some of a trajectory's snapshots; whoever adds one to it waits."""
        row = self._locked(trajectory_id)
        if row is None:
            return Removed(0, ())
        wanted = select(SnapshotRow.id).where(SnapshotRow.trajectory_id == trajectory_id, *conditions)
        chosen = SnapshotRow.id.in_(list(self._session.scalars(wanted.limit(REMOVED_AT_A_TIME))))
        pictures = self._pictures([chosen])
        reasons = self._session.scalars(delete(SnapshotRow).where(chosen).returning(SnapshotRow.reason)).all()
        self._count(row, reasons)
        return Removed(len(reasons), pictures)

    def _locked(self, trajectory_id: str) -> TrajectoryRow | None:
        return self._session.get(TrajectoryRow, trajectory_id, with_for_update=True, populate_existing=True)

    def _pictures(self, conditions: Sequence[ColumnElement[bool]]) -> tuple[str, ...]:
        query = select(KeptSnapshotRow.sha256).join(SnapshotRow, SnapshotRow.id == KeptSnapshotRow.pose_id)
        return tuple(self._session.scalars(query.where(*conditions)))

    def _count(self, row: TrajectoryRow, reasons: Sequence[str | None]) -> None:
        """Let a trajectory's totals follow the removal of located snapshots (no reason) and of refused ones."""
        left = {reason: count - reasons.count(reason) for reason, count in row.failures.items()}
        times = select(func.min(SnapshotRow.captured_s), func.max(SnapshotRow.captured_s))
        first_s, last_s = self._session.execute(times.where(SnapshotRow.trajectory_id == row.id)).one()
        row.failures = {reason: count for reason, count in left.items() if count}
        row.removed_count += len(reasons)
        row.first_s, row.last_s = first_s, last_s
        self._session.flush()
