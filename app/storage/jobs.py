"""Background jobs in the database: what was asked for, how far it is, how it ended."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, Literal, cast

from sqlalchemy import CursorResult, select, update
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.ids import new_id
from app.storage.models import JobRow

JobState = Literal["queued", "running", "succeeded", "failed", "cancelled"]
OPEN_STATES: tuple[JobState, ...] = ("queued", "running")


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
        The process that runs it.
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
    created_s: float
    finished_s: float | None

    @property
    def open(self) -> bool:
        """Whether there is still something to come."""
        return self.state in OPEN_STATES


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
            created_s=time.time(),
            started_s=None,
            finished_s=None,
        )
        self._session.add(row)
        self._session.flush()
        return _job(row)

    def get(self, job_id: str) -> Job:
        """One job.

        Raises
        ------
        NotFound
        """
        row = self._session.get(JobRow, job_id)
        if row is None:
            raise NotFound(f"there is no job {job_id}; a build's answer names its job_id", job_id=job_id)
        return _job(row)

    def open_jobs(self, site_id: str | None = None) -> tuple[Job, ...]:
        """Jobs that wait or run, the oldest first; of one site when named."""
        query = select(JobRow).where(JobRow.state.in_(OPEN_STATES)).order_by(JobRow.id)
        if site_id is not None:
            query = query.where(JobRow.site_id == site_id)
        return tuple(_job(row) for row in self._session.scalars(query))

    def claim(self, job_id: str, owner: str) -> bool:
        """Begin a waiting job; False when it waits no more."""
        return self._change(job_id, ("queued",), state="running", owner=owner, started_s=time.time())

    def progress(self, job_id: str, stage: str, done: int, total: int) -> bool:
        """Say how far a running job is; False when it runs no more."""
        return self._change(job_id, ("running",), stage=stage, done=done, total=total)

    def succeed(self, job_id: str, result: dict[str, Any]) -> bool:
        """End a running job with its result; False when it runs no more."""
        return self._end(job_id, ("running",), "succeeded", stage="done", done=JobRow.total, result=result)

    def fail(self, job_id: str, error: dict[str, Any]) -> bool:
        """End an open job with a problem; False when it is at its end already."""
        return self._end(job_id, OPEN_STATES, "failed", error=error)

    def cancel(self, job_id: str) -> bool:
        """End an open job on request; False when it is at its end already."""
        return self._end(job_id, OPEN_STATES, "cancelled")

    def _end(self, job_id: str, states: tuple[JobState, ...], state: JobState, **values: Any) -> bool:
        return self._change(job_id, states, state=state, finished_s=time.time(), **values)

    def _change(self, job_id: str, states: tuple[JobState, ...], **values: Any) -> bool:
        statement = update(JobRow).where(JobRow.id == job_id, JobRow.state.in_(states)).values(**values)
        result = self._session.execute(statement, execution_options={"synchronize_session": False})
        return cast("CursorResult[Any]", result).rowcount == 1


def _job(row: JobRow) -> Job:
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
        created_s=row.created_s,
        finished_s=row.finished_s,
    )
