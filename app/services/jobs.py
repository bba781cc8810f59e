"""Jobs as their owner sees them: how far, how ended, cancelled, tried again."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

from sqlalchemy.orm import Session

from app.errors import Conflict, ScattermarkError
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository
from app.storage.sites import SiteRepository

WATCH_INTERVAL_S = 0.2  # progress is written every tenth of a second; nobody reads faster


def find_job(database: Database, job_id: str) -> Job:
    """One job as it stands.

    Raises
    ------
    NotFound
    """
    with database.reading() as session:
        return JobRepository(session).get(job_id)


async def watch_job(database: Database, job_id: str) -> AsyncIterator[Job]:
    """A job at each change until it has ended, looked for in the database: whoever runs it is another process.

    Raises
    ------
    NotFound
    """
    shown: Job | None = None
    while shown is None or shown.open:
        job = await asyncio.to_thread(find_job, database, job_id)
        if job != shown:
            yield job
            shown = job
        if job.open:
            await asyncio.sleep(WATCH_INTERVAL_S)


def cancel_job(session: Session, job_id: str) -> Job:
    """End a job; its state is ``cancelled`` from here on and nothing of it is published.

    The workers see it in the table and end what is under way for it.

    Raises
    ------
    NotFound
    Conflict
        When the job has ended otherwise.
    """
    jobs = JobRepository(session)
    jobs.cancel(job_id)
    job = jobs.get(job_id)
    if job.state != "cancelled":
        raise Conflict(f"job {job_id} has {job.state} already and cannot be cancelled", job_id=job_id, state=job.state)
    return job


def retry_job(session: Session, job_id: str) -> Job:
    """Put a job that failed or was cancelled into the queue again, with the options it had.

    Photographs that were detected before are not detected again.

    Raises
    ------
    NotFound
    Conflict
        When the job waits, runs or has succeeded.
    """
    jobs = JobRepository(session)
    SiteRepository(session).lock(jobs.get(job_id).site_id)  # whoever removes the site sees the job, or we see no site
    if not jobs.retry(job_id):
        state = jobs.get(job_id).state
        advice = "start a new build instead" if state == "succeeded" else "wait for its end, or cancel it first"
        raise Conflict(f"job {job_id} is {state} and cannot be tried again; {advice}", job_id=job_id, state=state)
    return jobs.get(job_id)


def problem_of_error(error: ScattermarkError) -> dict[str, Any]:
    """An error as a job's row keeps it."""
    return {"slug": error.slug, "detail": error.detail, "fields": error.fields}
