"""The story of an evaluation in the service: a wish -> a worker compares and keeps -> told and reported when asked."""

from __future__ import annotations

from app.services.evaluate_work import EvaluationWish, make_evaluation
from app.services.evaluation_report_work import FileFormat, ToldEvaluation, tell_evaluation, write_evaluation_report
from app.services.ports import CpuPool
from app.storage.audit import waiting_entry
from app.storage.evaluation_records import StoredEvaluation


class Evaluator:
    """Evaluations in the pool: of a million poses they take minutes, which belong to no event loop and have a limit.

    Parameters
    ----------
    pool : CpuPool
        Whose workers have a workbench.
    timeout_s : float
        Of one evaluation, and of one report.
    """

    def __init__(self, pool: CpuPool, timeout_s: float) -> None:
        self._pool = pool
        self._timeout_s = timeout_s

    async def evaluate(self, wish: EvaluationWish) -> ToldEvaluation:
        """Compare systems with a reference, and keep what came out.

        Raises
        ------
        NotFound, Conflict, NothingMatched, DegenerateGeometry, InvalidInput
            As ``make_evaluation``; nothing is kept then.
        ServerFull, TimedOut, WorkerCrashed
            When the work could not be done; nothing is kept.
        """
        made: StoredEvaluation = await self._pool.run(make_evaluation, wish, waiting_entry(), timeout_s=self._timeout_s)
        return await self.tell(made.evaluation_id)

    async def tell(self, evaluation_id: str) -> ToldEvaluation:
        """An evaluation with its series.

        Raises
        ------
        NotFound
        ServerFull, TimedOut, WorkerCrashed
        """
        told: ToldEvaluation = await self._pool.run(tell_evaluation, evaluation_id, timeout_s=self._timeout_s)
        return told

    async def report(self, evaluation_id: str, wanted: FileFormat) -> bytes:
        """The report of an evaluation as the bytes of a file.

        Raises
        ------
        NotFound
        ServerFull, TimedOut, WorkerCrashed
        """
        content: bytes = await self._pool.run(write_evaluation_report, evaluation_id, wanted, timeout_s=self._timeout_s)
        return content
