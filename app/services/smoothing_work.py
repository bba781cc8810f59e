"""What a worker process does for a smoothed trajectory: poses between two looks, as sure as that allows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.errors import Conflict, InvalidInput
from app.services.workbench import workbench
from app.storage.pose_reading import all_poses
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import StoredTrajectory, TimeRange
from app.trajectories.smoothing.smoother import SmootherOptions, smooth_at
from app.trajectories.trajectory import Array, Trajectory

MOST_POSES = 20_000  # told or asked for: an hour at 5 Hz, some ten seconds of a worker


@dataclass(frozen=True)
class SmoothingWish:
    """When a trajectory is wanted.

    Attributes
    ----------
    times : TimeRange
        Poses of this range are used, and none is told outside of it.
    rate_hz : float or None
        So many poses a second from the first one on; or None with ``times_s``.
    times_s : tuple of float
        Or these moments, increasing.
    max_gap_s : float
        Between poses farther apart nothing is told.
    """

    trajectory_id: str
    times: TimeRange = TimeRange()
    rate_hz: float | None = None
    times_s: tuple[float, ...] = ()
    max_gap_s: float = SmootherOptions().max_gap_s

    def __post_init__(self) -> None:
        if (self.rate_hz is None) == (not self.times_s):
            raise InvalidInput("name either rate_hz or times", field="rate_hz")


@dataclass(frozen=True)
class SmoothedTrajectory:
    """A trajectory and its poses at the moments that were asked for, as far as it tells of them."""

    trajectory: StoredTrajectory
    poses: Trajectory


def smooth_trajectory(wish: SmoothingWish) -> SmoothedTrajectory:
    """The trajectory between its poses; of several poses at one moment the first counts.

    Raises
    ------
    NotFound
    Conflict
        When its poses have no orientations or no covariances.
    InvalidInput
        For more poses than can be told at once.
    """
    with workbench().database.reading() as session:
        trajectory = TrajectoryRepository(session).get(wish.trajectory_id)
        poses = all_poses(session, wish.trajectory_id, wish.times)
    if not len(poses):
        return SmoothedTrajectory(trajectory, poses)
    if poses.orientations_xyzw is None or poses.covariances is None:
        raise Conflict(
            f"trajectory {wish.trajectory_id} tells no orientations or no covariances, and smoothing takes both; take "
            "one that was located",
            trajectory_id=wish.trajectory_id,
        )
    once = poses.take(np.flatnonzero(np.diff(poses.times_s, prepend=-np.inf) > 0))
    moments_s = _moments_s(wish, once.times_s)
    if len(once) + len(moments_s) > MOST_POSES:
        raise InvalidInput(
            f"{len(once)} poses and {len(moments_s)} moments are more than {MOST_POSES} together; name a shorter range "
            "with from and to, or a lower rate",
            field="rate_hz",
        )
    return SmoothedTrajectory(trajectory, smooth_at(once, moments_s, SmootherOptions(max_gap_s=wish.max_gap_s)))


def _moments_s(wish: SmoothingWish, stamps_s: Array) -> Array:
    if wish.rate_hz is None:
        return np.array(wish.times_s)
    # One more than wanted at most: a range of a year at 1 kHz shall not fill the memory before it is refused.
    count = min(int((stamps_s[-1] - stamps_s[0]) * wish.rate_hz) + 1, MOST_POSES + 1)
    return np.asarray(stamps_s[0] + np.arange(count) / wish.rate_hz)
