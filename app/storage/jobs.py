"""Background jobs in the database: what was asked for, how far it is, how it ended. It is the truth about them."""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Literal, cast

from sqlalchemy import CursorResult, func, select, update
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.ids import new_id
from app.storage.models import JobRow
from app.storage.paging import Page, PageRequest, page_of

JobState = Literal["queued", "running", "succeeded", "failed", "cancelled"]
OPEN_STATES: tuple[JobState, ...] = ("queued", "running")
REPEATABLE_STATES: tuple[JobState, ...] = ("failed", "cancelled")


@dataclass(frozen=True)
class JobRun:
    """One attempt at a job. Work names it in all that it says, so that an attempt that was given up is not heard."""

    job_id: str
    attempt: int


@dataclass(frozen=True)
class Job:
    """A piece of background work.

    Attributes
    ----------
    options : dict
        What was asked for, as JSON.
    stage, done, total : str, int, int
        How far it is; photographs during detection.
    error : dict or None
        The problem that ended it: type's slug, detail, fields.
    owner : str or None
        The worker that runs it.
    attempt : int
        1, and one more with each retry.
    strikes : int
        Workers that died over it since it last got on.
    """

    job_id: str
    kind: str
    site_id: str
    survey_id: str
    options: dict[str, Any]
    state: JobState
    stage: str
    done: int
    total: int
    error: dict[str, Any] | None
    result: dict[str, Any] | None
    owner: str | None
    attempt: int
    strikes: int
    created_s: float
    finished_s: float | None

    @property
    def open(self) -> bool:
        """Whether there is still something to come."""
        return self.state in OPEN_STATES

    @property
    def run(self) -> JobRun:
        """The present attempt."""
        return JobRun(self.job_id, self.attempt)


@dataclass(frozen=True)
class JobFilter:
    """Which jobs a list shall hold; None is no condition.

    Attributes
    ----------
    site_ids : collection of str or None
        The sites whose jobs may be seen at all.
    """

    site_id: str | None = None
    state: JobState | None = None
    site_ids: Collection[str] | None = None


class JobRepository:
    """Jobs of one session. Each change names the state it leaves, so that a late one changes nothing."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, kind: str, site_id: str, survey_id: str, options: dict[str, Any]) -> Job:
        """A job that waits."""
        row = JobRow(
            id=new_id(),
            kind=kind,
            site_id=site_id,
            survey_id=survey_id,
            options=options,
            state="queued",
            stage="queued",
            done=0,
            total=0,
            error=None,
            result=None,
            owner=None,
            attempt=1,
            strikes=0,
            created_s=time.time(),
            started_s=None,
            finished_s=None,
        )
        self._session.add(row)
        self._session.flush()
        return job_of_row(row)

    def get(self, job_id: str) -> Job:
        """One job.

        Raises
        ------
        NotFound
        """
        row = self._session.get(JobRow, job_id)
        if row is None:
            raise NotFound(f"there is no job {job_id}; a build's answer names its job_id", job_id=job_id)
        return job_of_row(row)

    def page(self, wanted: JobFilter, request: PageRequest) -> Page[Job]:
        """Jobs, the newest first."""
        query = select(JobRow).order_by(JobRow.id.desc())
        if wanted.site_id is not None:
            query = query.where(JobRow.site_id == wanted.site_id)
        if wanted.site_ids is not None:
            query = query.where(JobRow.site_id.in_(wanted.site_ids))
        if wanted.state is not None:
            query = query.where(JobRow.state == wanted.state)
        if request.after is not None:
            query = query.where(JobRow.id < request.after)
        rows = self._session.scalars(query.limit(request.limit + 1))
        return page_of([(row.id, job_of_row(row)) for row in rows], request.limit)

    def open_jobs(self, site_id: str | None = None) -> tuple[Job, ...]:
        """Jobs that wait or run, the oldest first; of one site when named."""
        query = select(JobRow).where(JobRow.state.in_(OPEN_STATES)).order_by(JobRow.id)
        if site_id is not None:
            query = query.where(JobRow.site_id == site_id)
        return tuple(job_of_row(row) for row in self._session.scalars(query))

    def counts(self) -> dict[tuple[str, JobState], int]:
        """How many jobs there are, by kind and state."""
        query = select(JobRow.kind, JobRow.state, func.count()).group_by(JobRow.kind, JobRow.state)
        return {(kind, cast(JobState, state)): count for kind, state, count in self._session.execute(query)}

    def progress(self, run: JobRun, stage: str, done: int, total: int) -> bool:
        """Say how far a running job is; False when it runs no more, or in another attempt."""
        return self._change_run(run, stage=stage, done=done, total=total)

    def succeed(self, run: JobRun, result: dict[str, Any]) -> bool:
        """End a running job with its result; False when it runs no more, or in another attempt."""
        ended = {"state": "succeeded", "finished_s": time.time()}
        return self._change_run(run, **ended, stage="done", done=JobRow.total, result=result)

    def fail(self, run: JobRun, error: dict[str, Any]) -> bool:
        """End an open job with a problem; False when it is at its end already, or in another attempt."""
        return self._end(run.job_id, "failed", JobRow.attempt == run.attempt, error=error)

    def cancel(self, job_id: str) -> bool:
        """End an open job on request; False when it is at its end already."""
        return self._end(job_id, "cancelled")

    def retry(self, job_id: str) -> bool:
        """Put a job that failed or was cancelled into the queue again; False when it has not."""
        return self._change(job_id, REPEATABLE_STATES, **_FROM_THE_START, attempt=JobRow.attempt + 1)

    def _change_run(self, run: JobRun, **values: Any) -> bool:
        return self._change(run.job_id, ("running",), JobRow.attempt == run.attempt, **values)

    def _end(self, job_id: str, state: JobState, *conditions: Any, **values: Any) -> bool:
        return self._change(job_id, OPEN_STATES, *conditions, state=state, finished_s=time.time(), **values)

    def _change(self, job_id: str, states: tuple[JobState, ...], *conditions: Any, **values: Any) -> bool:
        statement = update(JobRow).where(JobRow.id == job_id, JobRow.state.in_(states), *conditions).values(**values)
        result = self._session.execute(statement, execution_options={"synchronize_session": False})
        return cast("CursorResult[Any]", result).rowcount == 1


_FROM_THE_START: dict[str, Any] = {
    "state": "queued",
    "stage": "queued",
    "done": 0,
    "total": 0,
    "error": None,
    "owner": None,
    "strikes": 0,
    "started_s": None,
    "finished_s": None,
}


def job_of_row(row: JobRow) -> Job:
    """A job without a trace of the database."""
    return Job(
        job_id=row.id,
        kind=row.kind,
        site_id=row.site_id,
        survey_id=row.survey_id,
        options=row.options,
        state=cast(JobState, row.state),
        stage=row.stage,
        done=row.done,
        total=row.total,
        error=row.error,
        result=row.result,
        owner=row.owner,
        attempt=row.attempt,
        strikes=row.strikes,
        created_s=row.created_s,
        finished_s=row.finished_s,
    )
