"""How far a job is, written seldom enough to cost nothing."""

from __future__ import annotations

import time

from app.errors import Cancelled
from app.storage.database import Database
from app.storage.jobs import JobRepository

WRITE_INTERVAL_S = 0.1  # whoever watches sees ten steps a second; a detection takes some tens of ms


class JobProgress:
    """Progress of one running job; also where the work learns that it was cancelled."""

    def __init__(self, database: Database, job_id: str) -> None:
        self._database = database
        self._job_id = job_id
        self._stage = ""
        self._written_s = float("-inf")

    def report(self, stage: str, done: int, total: int) -> None:
        """Say how far the job is; a new stage and the end of one are always written.

        Raises
        ------
        Cancelled
            When the job runs no more.
        """
        now_s = time.monotonic()
        if stage == self._stage and done < total and now_s - self._written_s < WRITE_INTERVAL_S:
            return
        self._stage, self._written_s = stage, now_s
        with self._database.writing() as session:
            running = JobRepository(session).progress(self._job_id, stage, done, total)
        if not running:
            raise Cancelled("the job was cancelled", job_id=self._job_id)
