"""The story of a report: a version's adjustment -> material -> document -> file."""

from __future__ import annotations

from app.services.ports import CpuPool
from app.services.report_work import ReportTask, WrittenReport, write_report


class ReportWriter:
    """Writes reports in the pool: a large survey's takes seconds, which belong to no event loop and have a limit.

    Parameters
    ----------
    pool : CpuPool
        Whose workers have a workbench.
    timeout_s : float
        Of one report.
    """

    def __init__(self, pool: CpuPool, timeout_s: float) -> None:
        self._pool = pool
        self._timeout_s = timeout_s

    async def write(self, task: ReportTask) -> WrittenReport:
        """The report of a version.

        Raises
        ------
        NotFound, Conflict
            When there is no such site or version, or no report of it.
        ServerFull, TimedOut, WorkerCrashed
            When the work could not be done.
        """
        report: WrittenReport = await self._pool.run(write_report, task, timeout_s=self._timeout_s)
        return report
