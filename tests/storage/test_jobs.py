from __future__ import annotations

from collections.abc import Callable

import pytest

from app.errors import NotFound
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository
from tests.storage import examples

OPTIONS = {"exclude": {"images": ["a.jpg"]}, "strictness": "strict"}


def new_job(database: Database) -> Job:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        return JobRepository(session).add("build", site.site_id, survey_id, OPTIONS)


def state(database: Database, job_id: str) -> Job:
    with database.reading() as session:
        return JobRepository(session).get(job_id)


def test_a_job_goes_its_way_and_keeps_what_it_says(database: Database) -> None:
    job = new_job(database)
    assert (job.state, job.stage, job.done, job.total, job.options) == ("queued", "queued", 0, 0, OPTIONS)
    with database.writing() as session:
        jobs = JobRepository(session)
        assert not jobs.progress(job.job_id, "detect", 1, 2)  # it does not run yet
        assert jobs.claim(job.job_id, "host/1")
        assert not jobs.claim(job.job_id, "host/2")
        assert jobs.progress(job.job_id, "detect", 3, 54)
    running = state(database, job.job_id)
    assert (running.state, running.stage, running.done, running.total, running.owner) == (
        "running",
        "detect",
        3,
        54,
        "host/1",
    )
    with database.writing() as session:
        assert JobRepository(session).succeed(job.job_id, {"map_version": 1})
    done = state(database, job.job_id)
    assert (done.state, done.result, done.error, done.open) == ("succeeded", {"map_version": 1}, None, False)
    assert (done.stage, done.done, done.total) == ("done", 54, 54)
    assert done.finished_s is not None


@pytest.mark.parametrize("end", ["succeed", "fail", "cancel"])
def test_a_job_ends_once(database: Database, end: str) -> None:
    job = new_job(database)
    with database.writing() as session:
        jobs = JobRepository(session)
        jobs.claim(job.job_id, "host/1")
        first: Callable[[], bool] = {
            "succeed": lambda: jobs.succeed(job.job_id, {}),
            "fail": lambda: jobs.fail(job.job_id, {}),
            "cancel": lambda: jobs.cancel(job.job_id),
        }[end]
        assert first()
        assert not jobs.succeed(job.job_id, {"late": True})
        assert not jobs.fail(job.job_id, {"late": True})
        assert not jobs.cancel(job.job_id)
        assert not jobs.progress(job.job_id, "late", 1, 1)
    ended = state(database, job.job_id)
    assert ended.state == {"succeed": "succeeded", "fail": "failed", "cancel": "cancelled"}[end]
    assert not ended.result
    assert not ended.error


def test_open_jobs_come_oldest_first_and_of_one_site_when_named(database: Database) -> None:
    jobs = [new_job(database) for _ in range(3)]
    with database.writing() as session:
        JobRepository(session).cancel(jobs[1].job_id)
    with database.reading() as session:
        found = JobRepository(session).open_jobs()
        assert {job.job_id for job in found} == {jobs[0].job_id, jobs[2].job_id}
        assert JobRepository(session).open_jobs(jobs[2].site_id) == (jobs[2],)
        with pytest.raises(NotFound, match="no job"):
            JobRepository(session).get("nowhere")
