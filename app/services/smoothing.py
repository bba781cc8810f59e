"""A trajectory at any time: smoothed in the pool, told as JSON or written as a file."""

from __future__ import annotations

from collections.abc import Iterator

from app.services.ports import CpuPool
from app.services.smoothing_work import SmoothedTrajectory, SmoothingWish, smooth_trajectory
from app.services.trajectory_export import TextFormat, writer_of
from app.storage.database import Database
from app.storage.sites import SiteRepository


class Smoother:
    """Smooths trajectories in the pool, with a time limit.

    Parameters
    ----------
    database : Database
    pool : CpuPool
        Whose workers have a workbench.
    timeout_s : float
    """

    def __init__(self, database: Database, pool: CpuPool, timeout_s: float) -> None:
        self._database = database
        self._pool = pool
        self._timeout_s = timeout_s

    async def smooth(self, wish: SmoothingWish) -> SmoothedTrajectory:
        """The trajectory at the moments of a wish.

        Raises
        ------
        NotFound, Conflict, InvalidInput
            As ``smooth_trajectory``.
        ServerFull, TimedOut, WorkerCrashed
        """
        smoothed: SmoothedTrajectory = await self._pool.run(smooth_trajectory, wish, timeout_s=self._timeout_s)
        return smoothed

    def text(self, smoothed: SmoothedTrajectory, wanted: TextFormat) -> Iterator[str]:
        """A smoothed trajectory as the text of a file.

        Raises
        ------
        Conflict
            When it cannot be written so.
        """
        with self._database.reading() as session:
            site = SiteRepository(session).get(smoothed.trajectory.site_id)
        return writer_of(wanted, smoothed.trajectory, site)([smoothed.poses] if len(smoothed.poses) else [])
