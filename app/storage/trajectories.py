"""Trajectories in the database: opened, filled with snapshots and refusals, closed."""

from __future__ import annotations

import time

from sqlalchemy import select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from app.storage.models import SnapshotRow, TrajectoryRow
from app.storage.snapshot_group import Entry, find_snapshot, record_one
from app.storage.snapshot_rows import snapshot_of_row
from app.storage.snapshots import NewSnapshot, Snapshot
from app.storage.trajectory_parts import StoredTrajectory
from app.storage.trajectory_rows import (
    DEFAULT_NAME,
    check_taking,
    default_key,
    first_values,
    no_trajectory,
    stored_trajectory,
    taken_id,
)
from app.storage.upsert import insert_if_absent


class TrajectoryRepository:
    """Trajectories of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, site_id: str, device_id: str | None, name: str, trajectory_id: str | None = None) -> StoredTrajectory:
        """A new trajectory without snapshots; under an id that was given before, the one that got it.

        Raises
        ------
        Conflict
            When a trajectory of another site has the id.
        """
        row = TrajectoryRow(default_key=None, **first_values(site_id, device_id, name))
        row.id = trajectory_id or row.id
        try:
            with self._session.begin_nested():  # whoever comes first makes it
                self._session.add(row)
        except IntegrityError:
            row = self._row(row.id)
        if row.site_id != site_id:
            raise taken_id(row.id)
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
        trajectory = self.get(trajectory_id)
        check_taking(trajectory, site_id)
        return trajectory

    def default(self, site_id: str, device_id: str | None) -> StoredTrajectory:
        """The open trajectory that collects a device's snapshots of a site; made when there is none."""
        query = select(TrajectoryRow).where(TrajectoryRow.default_key == default_key(site_id, device_id))
        query = query.with_for_update()  # nobody closes it before the transaction ends
        row = self._session.scalars(query).one_or_none()
        if row is None:
            values = first_values(site_id, device_id, DEFAULT_NAME)
            # Whoever comes first makes it.
            insert_if_absent(self._session, TrajectoryRow, default_key=default_key(site_id, device_id), **values)
            row = self._session.scalars(query).one()
        return stored_trajectory(row)

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
        return stored_trajectory(row)

    def record(self, trajectory_id: str, snapshot: NewSnapshot) -> Snapshot:
        """Add a snapshot; one whose ``snapshot_id`` the site already has is not added: the first one is returned.

        The trajectory's row is locked until the transaction ends, so that ordinals appear in their order.

        Raises
        ------
        NotFound, Conflict
            When the trajectory does not exist, is closed or belongs to another site.
        """
        return record_one(self._session.connection(), Entry(snapshot, trajectory_id))

    def find(self, site_id: str, snapshot_id: str) -> Snapshot | None:
        """The snapshot that a client gave this id, None when it has not come yet."""
        return find_snapshot(self._session.connection(), site_id, snapshot_id)

    def snapshots(self, trajectory_id: str, limit: int) -> tuple[Snapshot, ...]:
        """The first snapshots of a trajectory in the order of their time, with all that they showed."""
        query = select(SnapshotRow).where(SnapshotRow.trajectory_id == trajectory_id)
        rows = self._session.scalars(query.order_by(SnapshotRow.captured_s, SnapshotRow.ordinal).limit(limit))
        return tuple(snapshot_of_row(row) for row in rows)

    def _row(self, trajectory_id: str, *, lock: bool = False) -> TrajectoryRow:
        row = self._session.get(TrajectoryRow, trajectory_id, with_for_update=lock, populate_existing=True)
        if row is None:
            raise no_trajectory(trajectory_id)
        return row
