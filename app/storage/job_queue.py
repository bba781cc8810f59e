"""The job table as the workers' queue: who runs what, and whose work is free again because its worker is gone."""

from __future__ import annotations

import time
from collections.abc import Collection
from typing import Any, cast

from sqlalchemy import CursorResult, Update, select, update
from sqlalchemy.orm import Session

from app.storage.jobs import Job, JobRun, job_of_row
from app.storage.models import JobRow


class JobQueue:
    """Jobs of one session as workers see them."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def waiting(self, limit: int) -> tuple[Job, ...]:
        """Jobs that wait, the oldest first."""
        query = select(JobRow).where(JobRow.state == "queued").order_by(JobRow.id).limit(limit)
        return tuple(job_of_row(row) for row in self._session.scalars(query))

    def claim(self, run: JobRun, owner: str) -> bool:
        """Begin a waiting job; False when it waits no more, or for another attempt."""
        waiting = JobRow.id == run.job_id, JobRow.attempt == run.attempt, JobRow.state == "queued"
        values = {"state": "running", "owner": owner, "started_s": time.time()}
        return self._execute(update(JobRow).where(*waiting).values(**values)) == 1

    def running_of(self, owner: str) -> tuple[JobRun, ...]:
        """What a worker runs by the table."""
        query = select(JobRow.id, JobRow.attempt).where(JobRow.state == "running", JobRow.owner == owner)
        return tuple(JobRun(job_id, attempt) for job_id, attempt in self._session.execute(query))

    def still_running(self, runs: Collection[JobRun]) -> frozenset[JobRun]:
        """Those of the runs that shall go on: not cancelled, not ended, not overtaken by another attempt."""
        ids = {run.job_id for run in runs}
        query = select(JobRow.id, JobRow.attempt).where(JobRow.state == "running", JobRow.id.in_(ids))
        return frozenset(JobRun(job_id, attempt) for job_id, attempt in self._session.execute(query)) & set(runs)

    def take(self, run: JobRun, owner: str) -> bool:
        """Make a worker the one that runs a job; False when the job runs no more, or in another attempt."""
        return self._change([run.job_id], JobRow.attempt == run.attempt, owner=owner) == 1

    def got_on(self, run: JobRun) -> None:
        """A step of a job is done: what its workers died of was not this job."""
        self._change([run.job_id], JobRow.attempt == run.attempt, strikes=0)

    def strike(self, job_ids: Collection[str]) -> None:
        """A worker died while it was at work on these jobs."""
        self._change(job_ids, strikes=JobRow.strikes + 1)

    def hand_back(self, job_ids: Collection[str]) -> None:
        """Let another worker have these running jobs."""
        self._change(job_ids, state="queued", owner=None)

    def begin_anew(self, run: JobRun) -> JobRun | None:
        """Another attempt at a running job; None when it runs no more."""
        after = JobRun(run.job_id, run.attempt + 1)
        changed = self._change([run.job_id], JobRow.attempt == run.attempt, attempt=after.attempt)
        return after if changed else None

    def _change(self, job_ids: Collection[str], *conditions: Any, **values: Any) -> int:
        running = JobRow.id.in_(job_ids), JobRow.state == "running", *conditions
        return self._execute(update(JobRow).where(*running).values(**values))

    def _execute(self, statement: Update) -> int:
        result = self._session.execute(statement, execution_options={"synchronize_session": False})
        return cast("CursorResult[Any]", result).rowcount
