"""Jobs: listed, how far, live, cancelled, tried again."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends
from fastapi.sse import EventSourceResponse, ServerSentEvent

from app.api.dependencies import Id, Paging, PathId, ReadSession, Running, WriteSession
from app.api.problems import problems
from app.api.schemas.surveys import JobAnswer, JobsAnswer
from app.api.security import Surveying, needs
from app.services import jobs
from app.storage.jobs import Job, JobFilter, JobRepository, JobState

router = APIRouter(tags=["jobs"])


def existing_job(job_id: PathId, services: Running) -> Job:
    """A job, found before the stream of its events begins."""
    return jobs.find_job(services.database, job_id)


@router.get("/jobs", responses=problems(404, 422))
def list_jobs(
    page: Paging,
    session: ReadSession,
    principal: Surveying,
    site_id: Id | None = None,
    state: JobState | None = None,
) -> JobsAnswer:
    """Jobs, the newest first: all, those of a site, those in a state."""
    return JobsAnswer.of(JobRepository(session).page(JobFilter(site_id, state, principal.site_ids), page))


@router.get("/jobs/{job_id}", dependencies=[needs("survey")], responses=problems(404, 422))
def get_job(job: Annotated[Job, Depends(existing_job)]) -> JobAnswer:
    """How far a job is, or how it ended."""
    return JobAnswer.of(job)


@router.get(
    "/jobs/{job_id}/events",
    dependencies=[needs("survey")],
    response_class=EventSourceResponse,
    responses=problems(404, 422),
)
async def watch_job(job: Annotated[Job, Depends(existing_job)], services: Running) -> AsyncIterator[ServerSentEvent]:
    """The job at each change, as server-sent events; the stream ends with the job."""
    async for state in jobs.watch_job(services.database, job.job_id):
        yield ServerSentEvent(data=JobAnswer.of(state), event=None)


@router.post("/jobs/{job_id}/cancel", dependencies=[needs("survey")], responses=problems(404, 409, 422))
def cancel_job(job_id: PathId, session: WriteSession) -> JobAnswer:
    """End a job; nothing of it is published."""
    return JobAnswer.of(jobs.cancel_job(session, job_id))


@router.post("/jobs/{job_id}/retry", status_code=202, dependencies=[needs("survey")], responses=problems(404, 409, 422))
def retry_job(job_id: PathId, session: WriteSession) -> JobAnswer:
    """Put a job that failed or was cancelled into the queue again; what was detected is not detected again."""
    return JobAnswer.of(jobs.retry_job(session, job_id))
