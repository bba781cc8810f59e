"""The job table as the workers' queue."""

from __future__ import annotations

from app.storage.database import Database
from app.storage.job_queue import JobQueue
from app.storage.jobs import JobRepository, JobRun
from tests.storage.test_jobs import new_job, state


def test_jobs_are_taken_in_the_order_they_came(database: Database) -> None:
    jobs = sorted((new_job(database) for _ in range(3)), key=lambda job: job.job_id)
    with database.writing() as session:
        queue = JobQueue(session)
        assert queue.waiting(2) == tuple(jobs[:2])
        queue.claim(jobs[0].run, "worker 1")
        assert queue.waiting(5) == tuple(jobs[1:])
        assert queue.running_of("worker 1") == (jobs[0].run,)
        assert queue.running_of("worker 2") == ()


def test_who_goes_on_with_a_job_has_it(database: Database) -> None:
    job = new_job(database)
    with database.writing() as session:
        queue = JobQueue(session)
        assert not queue.take(job.run, "worker 2")  # it waits
        queue.claim(job.run, "worker 1")
        assert queue.take(job.run, "worker 2")
        assert not queue.take(JobRun(job.job_id, 2), "worker 3")
    assert state(database, job.job_id).owner == "worker 2"


def test_only_what_runs_in_this_attempt_goes_on(database: Database) -> None:
    runs, cancelled, retried = (new_job(database) for _ in range(3))
    with database.writing() as session:
        queue = JobQueue(session)
        for job in (runs, cancelled, retried):
            queue.claim(job.run, "worker 1")
        JobRepository(session).cancel(cancelled.job_id)
        assert queue.begin_anew(retried.run) == JobRun(retried.job_id, 2)
        assert queue.begin_anew(retried.run) is None
        asked = [runs.run, cancelled.run, retried.run, JobRun("gone", 1)]
        assert queue.still_running(asked) == {runs.run}


def test_strikes_count_until_the_job_gets_on(database: Database) -> None:
    job, other = new_job(database), new_job(database)
    with database.writing() as session:
        queue = JobQueue(session)
        queue.claim(job.run, "worker 1")
        queue.strike([job.job_id, "gone"])
        queue.strike([job.job_id])
    assert (state(database, job.job_id).strikes, state(database, other.job_id).strikes) == (2, 0)
    with database.writing() as session:
        JobQueue(session).got_on(job.run)
    assert state(database, job.job_id).strikes == 0


def test_what_is_handed_back_waits_and_what_has_ended_does_not(database: Database) -> None:
    job, ended = new_job(database), new_job(database)
    with database.writing() as session:
        queue = JobQueue(session)
        for one in (job, ended):
            queue.claim(one.run, "worker 1")
        JobRepository(session).progress(job.run, "detect", 3, 54)
        JobRepository(session).cancel(ended.job_id)
        queue.hand_back([job.job_id, ended.job_id])
    back = state(database, job.job_id)
    assert (back.state, back.owner, back.stage, back.done) == ("queued", None, "detect", 3)
    assert state(database, ended.job_id).state == "cancelled"
