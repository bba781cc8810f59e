"""Trajectories live: poses and failures as they come, whichever process adds them."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass

from app.errors import InvalidInput, NotFound
from app.services.trajectory_bell import TrajectoryBell, rung_or_late
from app.storage.database import Database
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import StoredTrajectory, TrajectoryPart
from app.storage.trajectory_queries import TrajectoryQueries

SNAPSHOTS_AT_A_TIME = 200  # of a backlog: a read of a few milliseconds
GREATEST_DIGITS = 10  # of a number of snapshots


@dataclass(frozen=True)
class Arrivals:
    """What came since the last look, and the trajectory at that moment."""

    trajectory: StoredTrajectory
    part: TrajectoryPart
    ordinal: int  # up to which all that came are told

    @property
    def empty(self) -> bool:
        """Whether nothing came."""
        return not (self.part.labels or self.part.failures)

    @property
    def behind(self) -> bool:
        """Whether there is more already."""
        return self.ordinal < self.trajectory.snapshot_count

    @property
    def ended(self) -> bool:
        """Whether nothing more can come."""
        return self.trajectory.closed_s is not None and not self.behind


def first_event(trajectory: StoredTrajectory, last_event_id: str | None) -> int:
    """The ordinal after which a stream begins: what the client saw last, else what there is now.

    Raises
    ------
    InvalidInput
        For an id that no event of this trajectory had.
    """
    if last_event_id is None:
        return trajectory.snapshot_count
    plausible = last_event_id.isascii() and last_event_id.isdigit() and len(last_event_id) <= GREATEST_DIGITS
    if not plausible or int(last_event_id) > trajectory.snapshot_count:
        raise InvalidInput(
            f"no event had the id {last_event_id!r}; send the last one that came, 0 for all, or none for what comes",
            field="Last-Event-ID",
        )
    return int(last_event_id)


async def watch_trajectory(
    database: Database, bell: TrajectoryBell, trajectory_id: str, after: int
) -> AsyncIterator[Arrivals]:
    """What comes to a trajectory after an ordinal, until it is closed or deleted.

    The last arrivals hold the closed trajectory and may be empty.
    """
    with bell.heard(trajectory_id) as rung:
        while True:
            rung.clear()
            try:
                found = await asyncio.to_thread(_look, database, trajectory_id, after)
            except NotFound:
                return  # deleted with its site: nothing more comes
            if found.ended or not found.empty:
                yield found
            if found.ended:
                return
            if not found.behind:
                await rung_or_late(rung)
            after = found.ordinal


def _look(database: Database, trajectory_id: str, after: int) -> Arrivals:
    """Both in one session, which sees one state: what is closed gets no more."""
    with database.reading() as session:
        trajectory = TrajectoryRepository(session).get(trajectory_id)
        part = TrajectoryQueries(session).arrivals(trajectory_id, after, SNAPSHOTS_AT_A_TIME)
    # Not counted from what came: some may have been removed.
    return Arrivals(trajectory, part, min(after + SNAPSHOTS_AT_A_TIME, trajectory.snapshot_count))
