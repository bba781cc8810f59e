"""The poses of a trajectory by time, whether they were located or came as a file."""

from __future__ import annotations

from collections.abc import Iterator

from app.storage.database import Database, Session
from app.storage.imported_trajectories import ImportedTrajectories
from app.storage.pose_blobs import joined
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import Place, StoredTrajectory, TimeRange
from app.storage.trajectory_queries import TrajectoryQueries
from app.trajectories.trajectory import Trajectory

POSES_AT_A_TIME = 2000  # a read of some tens of milliseconds, some hundred kilobytes of text
ROWS_AT_A_TIME = 20_000  # of located poses that are all wanted in memory: 10 MB


def pose_parts(database: Database, trajectory: StoredTrajectory, times: TimeRange) -> Iterator[Trajectory]:
    """The poses of a time range in pieces, none of them empty; each is read by a session of its own."""
    after: Place | None = None
    while True:
        with database.reading() as session:
            poses, after = _next(session, trajectory, times, (after, POSES_AT_A_TIME))
        if len(poses):
            yield poses
        if after is None:
            return


def all_poses(session: Session, trajectory_id: str, times: TimeRange | None = None) -> Trajectory:
    """The poses of a trajectory, or of a time range of it, as one session sees them.

    Raises
    ------
    NotFound
    """
    trajectory, times = TrajectoryRepository(session).get(trajectory_id), times or TimeRange()
    if trajectory.source is not None:
        pieces = [piece.poses for piece in ImportedTrajectories(session).pieces(trajectory_id, times)]
    else:
        pieces = list(_located(session, trajectory, times))
    filled = [piece for piece in pieces if len(piece)]
    return joined(filled or pieces or [Trajectory.empty()])


def _located(session: Session, trajectory: StoredTrajectory, times: TimeRange) -> Iterator[Trajectory]:
    after: Place | None = None
    while True:
        poses, after = _next(session, trajectory, times, (after, ROWS_AT_A_TIME))
        yield poses
        if after is None:
            return


def _next(
    session: Session, trajectory: StoredTrajectory, times: TimeRange, place: tuple[Place | None, int]
) -> tuple[Trajectory, Place | None]:
    after, limit = place
    if trajectory.source is None:
        return TrajectoryQueries(session).poses(trajectory.trajectory_id, times, after, limit)
    part = ImportedTrajectories(session).part(trajectory.trajectory_id, times, after, limit)
    return part.poses, part.end
