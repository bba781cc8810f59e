"""How far a job is, written seldom enough to cost nothing."""

from __future__ import annotations

import logging
import time

from app.errors import Cancelled
from app.storage.database import Database, StorageUnavailable
from app.storage.jobs import JobRepository, JobRun

log = logging.getLogger(__name__)

WRITE_INTERVAL_S = 0.1  # whoever watches sees ten steps a second; a detection takes some tens of ms


class JobProgress:
    """Progress of one attempt at a job; also where the work learns that it was cancelled."""

    def __init__(self, database: Database, run: JobRun) -> None:
        self._database = database
        self._run = run
        self._stage = ""
        self._written_s = float("-inf")

    def report(self, stage: str, done: int, total: int) -> None:
        """Say how far the job is; a new stage and the end of one are always written.

        A database that gives no answer does not end the work: the next report may reach it.

        Raises
        ------
        Cancelled
            When the job runs no more.
        """
        now_s = time.monotonic()
        if stage == self._stage and done < total and now_s - self._written_s < WRITE_INTERVAL_S:
            return
        self._stage, self._written_s = stage, now_s
        try:
            with self._database.writing() as session:
                running = JobRepository(session).progress(self._run, stage, done, total)
        except StorageUnavailable as error:
            log.warning("job %s: its progress cannot be written: %s", self._run.job_id, error.detail)
            return
        if not running:
            raise Cancelled("the job was cancelled", job_id=self._run.job_id)
