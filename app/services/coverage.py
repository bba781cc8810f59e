"""The story of predicted accuracy: a wish -> map, walls, camera -> grid of covariances -> file."""

from __future__ import annotations

from app.services.coverage_work import CoverageTask, predict_site
from app.services.ports import CpuPool


class Planner:
    """Predicts in the pool: a large site takes seconds.

    Parameters
    ----------
    pool : CpuPool
        Whose workers have a workbench.
    timeout_s : float
        Of one prediction.
    """

    def __init__(self, pool: CpuPool, timeout_s: float) -> None:
        self._pool = pool
        self._timeout_s = timeout_s

    async def predict(self, task: CoverageTask) -> bytes:
        """The prediction as the bytes of a file.

        Raises
        ------
        NotFound, Conflict, InvalidInput
            As ``predict_site``.
        ServerFull, TimedOut, WorkerCrashed
            When the work could not be done.
        """
        content: bytes = await self._pool.run(predict_site, task, timeout_s=self._timeout_s)
        return content
