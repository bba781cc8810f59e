"""The life of background builds: in turn, cancelled, failed, left behind by a process that died."""

from __future__ import annotations

import asyncio
import os
import socket
import subprocess
import sys
from collections.abc import Awaitable, Callable
from contextlib import asynccontextmanager

import pytest

from app.errors import Cancelled, Conflict, NotFound, SurveyFailed
from app.jobs import builds
from app.jobs.builds import BuildRunner
from app.services.jobs import cancel_job, watch_job
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository
from tests.storage.examples import site_with_survey

ANSWER_S = 30.0


class FakeBuilder:
    """Does what a test says in the place of a build."""

    def __init__(self, work: Callable[[Job], Awaitable[None]]) -> None:
        self.build = work


def new_job(database: Database) -> Job:
    site, survey_id = site_with_survey(database)
    with database.writing() as session:
        return JobRepository(session).add("build", site.site_id, survey_id, {})


def state_of(database: Database, job_id: str) -> Job:
    with database.reading() as session:
        return JobRepository(session).get(job_id)


@asynccontextmanager
async def running(database: Database, work: Callable[[Job], Awaitable[None]]):  # type: ignore[no-untyped-def]
    runner = BuildRunner(database, FakeBuilder(work))  # type: ignore[arg-type]
    await runner.start()
    try:
        yield runner
    finally:
        await runner.close()


async def ended(database: Database, job_id: str) -> Job:
    async with asyncio.timeout(ANSWER_S):
        async for job in watch_job(database, job_id):
            last = job
    return last


def test_builds_run_one_at_a_time_in_the_order_they_came(database: Database) -> None:
    jobs = [new_job(database) for _ in range(3)]
    log: list[tuple[str, str]] = []

    async def work(job: Job) -> None:
        log.append(("begin", job.job_id))
        assert job.state == "queued"  # as it was found
        assert state_of(database, job.job_id).state == "running"
        await asyncio.sleep(0.01)
        log.append(("end", job.job_id))
        with database.writing() as session:
            JobRepository(session).succeed(job.job_id, {"map_version": 1})

    async def story() -> None:
        async with running(database, work):
            for job in jobs:
                assert (await ended(database, job.job_id)).state == "succeeded"

    asyncio.run(story())
    assert log == [(what, job.job_id) for job in jobs for what in ("begin", "end")]


def test_a_build_that_is_put_in_later_is_found(database: Database) -> None:
    async def work(job: Job) -> None:
        with database.writing() as session:
            JobRepository(session).succeed(job.job_id, {})

    async def story() -> None:
        async with running(database, work) as runner:
            job = await asyncio.to_thread(new_job, database)
            await asyncio.to_thread(runner.wake)
            assert (await ended(database, job.job_id)).state == "succeeded"

    asyncio.run(story())


@pytest.mark.parametrize(
    ("error", "slug", "detail"),
    [
        (SurveyFailed("the photographs do not overlap", reason="no-overlap"), "survey-failed", "do not overlap"),
        (ZeroDivisionError("a fault"), "error", "report incident"),
    ],
)
def test_a_build_that_fails_says_why_and_the_next_one_runs(
    database: Database, error: Exception, slug: str, detail: str, caplog: pytest.LogCaptureFixture
) -> None:
    bad, good = new_job(database), new_job(database)

    async def work(job: Job) -> None:
        if job.job_id == bad.job_id:
            raise error
        with database.writing() as session:
            JobRepository(session).succeed(job.job_id, {})

    async def story() -> None:
        async with running(database, work):
            failed = await ended(database, bad.job_id)
            assert failed.state == "failed"
            assert failed.error is not None
            assert failed.error["slug"] == slug
            assert detail in failed.error["detail"]
            assert (await ended(database, good.job_id)).state == "succeeded"

    asyncio.run(story())
    assert ("a fault" in caplog.text) == isinstance(error, ZeroDivisionError)


def test_cancelling_ends_the_work_and_the_next_one_runs(database: Database) -> None:
    long, next_one = new_job(database), new_job(database)
    reached: list[str] = []

    async def work(job: Job) -> None:
        if job.job_id == long.job_id:
            reached.append("begun")
            try:
                await asyncio.sleep(ANSWER_S)
            except asyncio.CancelledError:
                reached.append("ended")
                raise
        with database.writing() as session:
            JobRepository(session).succeed(job.job_id, {})

    async def story() -> None:
        async with running(database, work) as runner:
            while not reached:
                await asyncio.sleep(0.01)
            cancelled = await asyncio.to_thread(cancel_job, database, runner, long.job_id)
            assert cancelled.state == "cancelled"
            assert (await ended(database, next_one.job_id)).state == "succeeded"

    asyncio.run(story())
    assert reached == ["begun", "ended"]
    assert state_of(database, long.job_id).state == "cancelled"


def test_a_waiting_build_is_cancelled_before_it_begins(database: Database) -> None:
    async def work(_job: Job) -> None:
        raise AssertionError("it was cancelled")

    async def story() -> None:
        job = new_job(database)
        runner = BuildRunner(database, FakeBuilder(work))  # type: ignore[arg-type]
        cancel_job(database, runner, job.job_id)
        async with running(database, work):
            assert (await ended(database, job.job_id)).state == "cancelled"

    asyncio.run(story())


def test_what_has_ended_cannot_be_cancelled(database: Database) -> None:
    job = new_job(database)
    runner = BuildRunner(database, FakeBuilder(lambda _job: asyncio.sleep(0)))  # type: ignore[arg-type]
    with database.writing() as session:
        JobRepository(session).fail(job.job_id, {})
    with pytest.raises(Conflict, match="has failed already"):
        cancel_job(database, runner, job.job_id)
    with pytest.raises(NotFound):
        cancel_job(database, runner, "nowhere")


def test_work_that_notices_the_cancelling_itself_changes_nothing(database: Database) -> None:
    job = new_job(database)

    async def work(job: Job) -> None:
        with database.writing() as session:
            JobRepository(session).cancel(job.job_id)
        raise Cancelled("the job was cancelled")

    async def story() -> None:
        async with running(database, work):
            assert (await ended(database, job.job_id)).state == "cancelled"

    asyncio.run(story())


def test_a_build_that_the_server_stops_under_is_failed_and_says_so(database: Database) -> None:
    job = new_job(database)
    begun = asyncio.Event()

    async def work(_job: Job) -> None:
        begun.set()
        await asyncio.sleep(ANSWER_S)

    async def story() -> None:
        async with running(database, work):
            await begun.wait()

    asyncio.run(story())
    stopped = state_of(database, job.job_id)
    assert stopped.state == "failed"
    assert stopped.error is not None
    assert stopped.error["slug"] == "build-interrupted"
    assert "start the build again" in stopped.error["detail"]


def dead_process() -> int:
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


@pytest.mark.parametrize(
    ("owner", "state"),
    [
        (lambda: f"{socket.gethostname()}/{dead_process()}", "failed"),
        (lambda: f"{socket.gethostname()}/{os.getpid()}", "failed"),  # a container's process numbers come back
        (lambda: f"{socket.gethostname()}/{os.getppid()}", "running"),
        (lambda: f"another-machine/{dead_process()}", "running"),
    ],
)
def test_builds_of_a_dead_process_are_failed_at_the_start(
    database: Database, owner: Callable[[], str], state: str
) -> None:
    job = new_job(database)
    with database.writing() as session:
        JobRepository(session).claim(job.job_id, owner())

    async def story() -> None:
        async with running(database, lambda _job: asyncio.sleep(0)):
            pass

    asyncio.run(story())
    assert state_of(database, job.job_id).state == state


def test_a_database_that_is_away_for_a_moment_does_not_end_the_runner(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(builds, "RETRY_PAUSE_S", 0.01)
    job = new_job(database)
    claims = iter([True, True])

    async def work(job: Job) -> None:
        with database.writing() as session:
            JobRepository(session).succeed(job.job_id, {})

    class Unlucky(BuildRunner):
        def _claim(self) -> Job | None:
            if next(claims, False):
                raise NotFound("the database is away")
            return super()._claim()

    async def story() -> None:
        runner = Unlucky(database, FakeBuilder(work))  # type: ignore[arg-type]
        await runner.start()
        assert (await ended(database, job.job_id)).state == "succeeded"
        await runner.close()

    asyncio.run(story())
