"""The story of a build with a pool that does what a test says."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import pytest

from app.errors import Cancelled, SurveyFailed, TimedOut, WorkerCrashed
from app.services import adjust_work
from app.services.adjust_work import AdjustTask, Unreadable, adjust_and_publish
from app.services.build_map import BuildLimits, MapBuilder
from app.services.build_options import BuildOptions, Exclusion
from app.services.detect_work import DetectSettings, DetectTask
from app.services.job_progress import JobProgress
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.vision.photo import PhotoLimits
from tests.storage import examples

LIMITS = BuildLimits(PhotoLimits(), width=2, detect_timeout_s=60.0, adjust_timeout_s=600.0)
PHOTOS = {"a.jpg": "a" * 64, "b.jpg": "b" * 64, "c.jpg": "c" * 64, "twin of a.jpg": "a" * 64}


class FakePool:
    """Answers by a function of the task, or not at all while it returns None."""

    def __init__(self, answer: Callable[[Any], Any]) -> None:
        self.answer = answer
        self.tasks: list[Any] = []
        self.futures: list[Future[Any]] = []

    def submit(self, function: Callable[..., Any], task: Any, timeout_s: float | None = None) -> Future[Any]:
        expected_s = LIMITS.adjust_timeout_s if function is adjust_and_publish else LIMITS.detect_timeout_s
        assert timeout_s == expected_s
        self.tasks.append(task)
        future: Future[Any] = Future()
        self.futures.append(future)
        try:
            answered = self.answer(task)
        except Exception as error:  # noqa: BLE001 - what a worker raises
            future.set_exception(error)
        else:
            if answered is not NEVER:
                future.set_result(answered)
        return future

    @property
    def detected(self) -> list[str]:
        return [task.sha256 for task in self.tasks if isinstance(task, DetectTask)]

    @property
    def adjusted(self) -> list[AdjustTask]:
        return [task for task in self.tasks if isinstance(task, AdjustTask)]


NEVER = object()


def running_job(database: Database, options: BuildOptions | None = None) -> Job:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        for name, sha256 in PHOTOS.items():
            SurveyRepository(session).add_photo(survey_id, examples.photo(name, sha256))
        job = JobRepository(session).add("build", site.site_id, survey_id, (options or BuildOptions()).to_json())
        JobRepository(session).claim(job.job_id, "host/1")
    return job


def build(database: Database, pool: FakePool, job: Job) -> None:
    asyncio.run(MapBuilder(database, pool, LIMITS).build(job))  # type: ignore[arg-type]


def test_each_new_photograph_is_detected_once_then_all_are_adjusted(database: Database) -> None:
    job = running_job(database)
    with database.writing() as session:
        key = DetectSettings.of("golay", BuildOptions()).key(PHOTOS["b.jpg"])
        DetectionRepository(session).put(key, examples.detection())
    pool = FakePool(lambda _task: None)
    build(database, pool, job)
    assert sorted(pool.detected) == [PHOTOS["a.jpg"], PHOTOS["c.jpg"]]
    assert pool.adjusted == [AdjustTask(job.job_id, ())]
    assert isinstance(pool.tasks[-1], AdjustTask)
    with database.reading() as session:
        told = JobRepository(session).get(job.job_id)
    assert (told.stage, told.done, told.total) == ("detect", 3, 3)


def test_excluded_photographs_are_not_even_looked_at(database: Database) -> None:
    pool = FakePool(lambda _task: None)
    build(database, pool, running_job(database, BuildOptions(Exclusion(images=("c.jpg",)), "eager")))
    assert set(pool.detected) == {PHOTOS["a.jpg"], PHOTOS["b.jpg"]}
    assert {task.settings.strictness for task in pool.tasks if isinstance(task, DetectTask)} == {"eager"}


@pytest.mark.parametrize("failure", ["truncated", TimedOut("too slow"), WorkerCrashed("it died")])
def test_one_bad_photograph_does_not_end_the_build(database: Database, failure: object) -> None:
    job = running_job(database)

    def answer(task: Any) -> Any:
        if isinstance(task, DetectTask) and task.sha256 == PHOTOS["a.jpg"]:
            if isinstance(failure, Exception):
                raise failure
            return failure
        return None

    pool = FakePool(answer)
    build(database, pool, job)
    reason = failure.detail if isinstance(failure, (TimedOut, WorkerCrashed)) else str(failure)
    expected = (Unreadable("a.jpg", reason), Unreadable("twin of a.jpg", reason))
    assert pool.adjusted == [AdjustTask(job.job_id, expected)]


def test_what_the_adjustment_raises_ends_the_build(database: Database) -> None:
    def answer(task: Any) -> Any:
        if isinstance(task, AdjustTask):
            raise SurveyFailed("no overlap", reason="no-overlap")
        return None

    with pytest.raises(SurveyFailed, match="no overlap"):
        build(database, FakePool(answer), running_job(database))


def test_a_cancelled_build_ends_the_work_that_is_under_way(database: Database) -> None:
    job, pool = running_job(database), FakePool(lambda _task: NEVER)

    async def story() -> None:
        work = asyncio.create_task(MapBuilder(database, pool, LIMITS).build(job))  # type: ignore[arg-type]
        while len(pool.futures) < LIMITS.width:
            await asyncio.sleep(0.001)
        work.cancel()
        with pytest.raises(asyncio.CancelledError):
            await work

    asyncio.run(story())
    assert all(future.cancelled() for future in pool.futures)
    assert pool.adjusted == []


def test_a_build_notices_that_its_job_was_cancelled_elsewhere(database: Database) -> None:
    job = running_job(database)
    with database.writing() as session:
        JobRepository(session).cancel(job.job_id)
    pool = FakePool(lambda _task: None)
    with pytest.raises(Cancelled):
        build(database, pool, job)
    assert pool.adjusted == []


def test_a_cancelled_job_publishes_nothing_even_at_the_last_moment(database: Database) -> None:
    job = running_job(database)
    with database.reading() as session:
        material = adjust_work._gather(session, AdjustTask(job.job_id, ()))
    publication = examples.publication(job.job_id, job.survey_id)
    with database.writing() as session:
        JobRepository(session).cancel(job.job_id)
    with pytest.raises(Cancelled):
        adjust_work._publish(database, material, publication)
    with database.reading() as session, pytest.raises(Exception, match="no target map version 1"):
        TargetMapRepository(session).load(job.site_id, 1)


def test_a_published_map_and_its_jobs_success_come_together(database: Database) -> None:
    job = running_job(database)
    with database.reading() as session:
        material = adjust_work._gather(session, AdjustTask(job.job_id, ()))
    version = adjust_work._publish(database, material, examples.publication(job.job_id, job.survey_id))
    with database.reading() as session:
        done = JobRepository(session).get(job.job_id)
        assert TargetMapRepository(session).version(job.site_id, None).version == version == 1
    expected = {"map_version": 1, "targets": len(examples.CODES), "photographs": 2, "unoriented": 1}
    assert (done.state, done.result) == ("succeeded", expected)


def test_progress_is_written_at_new_stages_and_ends_and_seldom_between(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = running_job(database)
    written: list[tuple[str, int]] = []
    original = JobRepository.progress

    def progress(self: JobRepository, job_id: str, stage: str, done: int, total: int) -> bool:
        written.append((stage, done))
        return original(self, job_id, stage, done, total)

    monkeypatch.setattr(JobRepository, "progress", progress)
    monkeypatch.setattr("app.services.job_progress.WRITE_INTERVAL_S", 1e6)
    watcher = JobProgress(database, job.job_id)
    for stage in ("detect", "network"):
        for done in range(5):
            watcher.report(stage, done, 4)
    assert written == [("detect", 0), ("detect", 4), ("network", 0), ("network", 4)]
