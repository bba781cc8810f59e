"""The life of a job in the database: how far, how ended, tried again, and never told by an attempt that is over."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from app.errors import NotFound
from app.storage.database import Database
from app.storage.job_queue import JobQueue
from app.storage.jobs import Job, JobFilter, JobRepository, JobRun
from app.storage.paging import PageRequest
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
        assert not jobs.progress(job.run, "detect", 1, 2)  # it does not run yet
        assert JobQueue(session).claim(job.run, "worker 1")
        assert not JobQueue(session).claim(job.run, "worker 2")
        assert jobs.progress(job.run, "detect", 3, 54)
    running = state(database, job.job_id)
    assert (running.state, running.stage, running.done, running.total, running.owner) == (
        "running",
        "detect",
        3,
        54,
        "worker 1",
    )
    with database.writing() as session:
        assert JobRepository(session).succeed(job.run, {"map_version": 1})
    done = state(database, job.job_id)
    assert (done.state, done.result, done.error, done.open) == ("succeeded", {"map_version": 1}, None, False)
    assert (done.stage, done.done, done.total) == ("done", 54, 54)
    assert done.finished_s is not None


@pytest.mark.parametrize("end", ["succeed", "fail", "cancel"])
def test_a_job_ends_once(database: Database, end: str) -> None:
    job = new_job(database)
    with database.writing() as session:
        jobs = JobRepository(session)
        JobQueue(session).claim(job.run, "worker 1")
        first: Callable[[], bool] = {
            "succeed": lambda: jobs.succeed(job.run, {}),
            "fail": lambda: jobs.fail(job.run, {}),
            "cancel": lambda: jobs.cancel(job.job_id),
        }[end]
        assert first()
        assert not jobs.succeed(job.run, {"late": True})
        assert not jobs.fail(job.run, {"late": True})
        assert not jobs.cancel(job.job_id)
        assert not jobs.progress(job.run, "late", 1, 1)
    ended = state(database, job.job_id)
    assert ended.state == {"succeed": "succeeded", "fail": "failed", "cancel": "cancelled"}[end]
    assert not ended.result
    assert not ended.error


@pytest.mark.parametrize("end", ["fail", "cancel"])
def test_what_failed_or_was_cancelled_is_tried_again_as_if_it_were_new(database: Database, end: str) -> None:
    job = new_job(database)
    with database.writing() as session:
        jobs, queue = JobRepository(session), JobQueue(session)
        assert not jobs.retry(job.job_id)  # it waits
        queue.claim(job.run, "worker 1")
        queue.strike([job.job_id])
        assert not jobs.retry(job.job_id)  # it runs
        jobs.progress(job.run, "detect", 3, 54)
        assert jobs.fail(job.run, {"slug": "x"}) if end == "fail" else jobs.cancel(job.job_id)
        assert jobs.retry(job.job_id)
    again = state(database, job.job_id)
    assert (again.state, again.stage, again.done, again.total) == ("queued", "queued", 0, 0)
    assert (again.error, again.owner, again.finished_s, again.strikes) == (None, None, None, 0)
    assert (again.attempt, again.options, again.created_s) == (2, OPTIONS, job.created_s)


def test_a_success_is_not_tried_again(database: Database) -> None:
    job = new_job(database)
    with database.writing() as session:
        JobQueue(session).claim(job.run, "worker 1")
        JobRepository(session).succeed(job.run, {})
        assert not JobRepository(session).retry(job.job_id)


def test_an_attempt_that_is_over_is_not_heard(database: Database) -> None:
    job = new_job(database)
    with database.writing() as session:
        jobs, queue = JobRepository(session), JobQueue(session)
        jobs.cancel(job.job_id)
        jobs.retry(job.job_id)
        assert not queue.claim(job.run, "worker 1")
        assert queue.claim(JobRun(job.job_id, 2), "worker 1")
        assert not jobs.progress(job.run, "late", 1, 1)
        assert not jobs.succeed(job.run, {"late": True})
        assert not jobs.fail(job.run, {"late": True})
        assert jobs.progress(JobRun(job.job_id, 2), "detect", 1, 2)


def test_the_list_is_paged_and_filtered_newest_first(database: Database) -> None:
    jobs = [new_job(database) for _ in range(3)]
    newest_first = sorted((job.job_id for job in jobs), reverse=True)
    with database.writing() as session:
        JobRepository(session).cancel(jobs[1].job_id)

    def ids(wanted: JobFilter, request: PageRequest | None = None) -> list[str]:
        with database.reading() as session:
            return [job.job_id for job in JobRepository(session).page(wanted, request or PageRequest()).items]

    assert ids(JobFilter()) == newest_first
    assert ids(JobFilter(state="cancelled")) == [jobs[1].job_id]
    assert ids(JobFilter(site_id=jobs[0].site_id)) == [jobs[0].job_id]
    assert ids(JobFilter(site_ids=[jobs[0].site_id, jobs[2].site_id], state="cancelled")) == []
    assert ids(JobFilter(site_ids=[])) == []
    with database.reading() as session:
        first = JobRepository(session).page(JobFilter(), PageRequest(limit=2))
    assert ids(JobFilter(), PageRequest(2, first.next_cursor)) == newest_first[2:]


def test_jobs_are_counted_by_kind_and_state(database: Database) -> None:
    jobs = [new_job(database) for _ in range(3)]
    with database.writing() as session:
        JobRepository(session).cancel(jobs[0].job_id)
    with database.reading() as session:
        assert JobRepository(session).counts() == {("build", "queued"): 2, ("build", "cancelled"): 1}


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
