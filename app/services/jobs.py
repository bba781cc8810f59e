"""Jobs as their owner sees them: how far, how ended, cancelled."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from typing import Any

from app.errors import Conflict, ScattermarkError
from app.services.ports import BuildQueue
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository

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
    """A job at each change until it has ended, looked for in the database: whoever runs it may be another process.

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


def cancel_job(database: Database, queue: BuildQueue, job_id: str) -> Job:
    """End a job; its state is ``cancelled`` from here on and nothing of it is published.

    Raises
    ------
    NotFound
    Conflict
        When the job has ended otherwise.
    """
    with database.writing() as session:
        jobs = JobRepository(session)
        jobs.cancel(job_id)
        job = jobs.get(job_id)
    if job.state != "cancelled":
        raise Conflict(f"job {job_id} has {job.state} already and cannot be cancelled", job_id=job_id, state=job.state)
    queue.stop(job_id)
    return job


def problem_of_error(error: ScattermarkError) -> dict[str, Any]:
    """An error as a job's row keeps it."""
    return {"slug": error.slug, "detail": error.detail, "fields": error.fields}
