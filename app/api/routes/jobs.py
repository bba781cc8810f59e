"""Jobs: how far, live, cancelled."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends
from fastapi.sse import EventSourceResponse, ServerSentEvent

from app.api.dependencies import PathId, Running
from app.api.problems import problems
from app.api.schemas.surveys import JobAnswer
from app.api.security import needs
from app.services import jobs
from app.storage.jobs import Job

router = APIRouter(tags=["jobs"], dependencies=[needs("survey")])


def existing_job(job_id: PathId, services: Running) -> Job:
    """A job, found before the stream of its events begins."""
    return jobs.find_job(services.database, job_id)


@router.get("/jobs/{job_id}", responses=problems(404, 422))
def get_job(job: Annotated[Job, Depends(existing_job)]) -> JobAnswer:
    """How far a job is, or how it ended."""
    return JobAnswer.of(job)


@router.get("/jobs/{job_id}/events", response_class=EventSourceResponse, responses=problems(404, 422))
async def watch_job(job: Annotated[Job, Depends(existing_job)], services: Running) -> AsyncIterator[ServerSentEvent]:
    """The job at each change, as server-sent events; the stream ends with the job."""
    async for state in jobs.watch_job(services.database, job.job_id):
        yield ServerSentEvent(data=JobAnswer.of(state), event=None)


@router.post("/jobs/{job_id}/cancel", responses=problems(404, 409, 422))
def cancel_job(job_id: PathId, services: Running) -> JobAnswer:
    """End a job; nothing of it is published."""
    return JobAnswer.of(jobs.cancel_job(services.database, services.builds, job_id))
