"""The steps of a build with a pool that does what a test says."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any

import pytest

from app.errors import Cancelled, StorageUnavailable, SurveyFailed, TimedOut, WorkerCrashed
from app.services import adjust_work, write_patiently
from app.services.adjust_work import AdjustTask, Unreadable, adjust_and_publish
from app.services.build_map import PHOTOS_PER_CHUNK, BuildLimits, MapBuilder
from app.services.build_options import BuildOptions, Exclusion
from app.services.detect_work import DetectSettings, DetectTask
from app.services.job_progress import JobProgress
from app.storage.database import Database
from app.storage.job_queue import JobQueue
from app.storage.jobs import Job, JobRepository, JobRun
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.vision.photo import PhotoLimits
from tests.storage import examples

LIMITS = BuildLimits(PhotoLimits(), detect_timeout_s=60.0, adjust_timeout_s=600.0)
PHOTOS = {"a.jpg": "a" * 64, "b.jpg": "b" * 64, "c.jpg": "c" * 64, "twin of a.jpg": "a" * 64}


class FakePool:
    """Answers by a function of the task, or not until it is ended when that says NEVER."""

    def __init__(self, answer: Callable[[Any], Any]) -> None:
        self.answer = answer
        self.tasks: list[Any] = []
        self.began = threading.Event()

    def submit(self, function: Callable[..., Any], task: Any, timeout_s: float | None = None) -> Future[Any]:
        expected_s = LIMITS.adjust_timeout_s if function is adjust_and_publish else LIMITS.detect_timeout_s
        assert timeout_s == expected_s
        self.tasks.append(task)
        future: Future[Any] = EndedFuture()
        try:
            answered = self.answer(task)
        except Exception as error:  # noqa: BLE001 - what a worker raises
            future.set_exception(error)
        else:
            if answered is not NEVER:
                future.set_result(answered)
        self.began.set()
        return future

    @property
    def detected(self) -> list[str]:
        return [task.sha256 for task in self.tasks if isinstance(task, DetectTask)]

    @property
    def adjusted(self) -> list[AdjustTask]:
        return [task for task in self.tasks if isinstance(task, AdjustTask)]


class EndedFuture(Future[Any]):
    """As the pool's: a cancelled one raises our own error."""

    def cancel(self) -> bool:
        self.set_exception(Cancelled("the work was ended on request"))
        return True


NEVER = object()


def running_job(database: Database, options: BuildOptions | None = None) -> Job:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        for name, sha256 in PHOTOS.items():
            SurveyRepository(session).add_photo(survey_id, examples.photo(name, sha256))
        job = JobRepository(session).add("build", site.site_id, survey_id, (options or BuildOptions()).to_json())
        JobQueue(session).claim(job.run, "worker 1")
    return job


def builder_of(database: Database, answer: Callable[[Any], Any] = lambda _task: None) -> tuple[MapBuilder, FakePool]:
    pool = FakePool(answer)
    return MapBuilder(database, pool, LIMITS), pool  # type: ignore[arg-type]


def keep_detection(database: Database, name: str) -> None:
    with database.writing() as session:
        key = DetectSettings.of("golay", BuildOptions()).key(PHOTOS[name])
        DetectionRepository(session).put(key, examples.detection())


def told(database: Database, job: Job) -> Job:
    with database.reading() as session:
        return JobRepository(session).get(job.job_id)


def test_each_photograph_that_is_new_is_planned_once(database: Database) -> None:
    job = running_job(database)
    keep_detection(database, "b.jpg")
    builder, _ = builder_of(database)
    assert builder.plan(job.run) == ((PHOTOS["a.jpg"], PHOTOS["c.jpg"]),)


def test_many_photographs_are_planned_in_chunks(database: Database) -> None:
    job = running_job(database)
    with database.writing() as session:
        for number in range(2 * PHOTOS_PER_CHUNK):
            SurveyRepository(session).add_photo(job.survey_id, examples.photo(f"more {number}.jpg", f"{number:064}"))
    builder, _ = builder_of(database)
    assert [len(chunk) for chunk in builder.plan(job.run)] == [PHOTOS_PER_CHUNK, PHOTOS_PER_CHUNK, 3]


def test_excluded_photographs_are_not_even_looked_at(database: Database) -> None:
    job = running_job(database, BuildOptions(Exclusion(images=("c.jpg",)), "eager"))
    builder, pool = builder_of(database)
    (chunk,) = builder.plan(job.run)
    assert set(chunk) == {PHOTOS["a.jpg"], PHOTOS["b.jpg"]}
    builder.detect(job.run, chunk)
    assert {task.settings.strictness for task in pool.tasks} == {"eager"}


def test_a_chunk_that_is_done_again_does_what_was_not_done(database: Database) -> None:
    job = running_job(database)
    with database.writing() as session:
        JobQueue(session).strike([job.job_id])
    builder, pool = builder_of(database)
    keep_detection(database, "a.jpg")
    assert builder.detect(job.run, [PHOTOS["a.jpg"], PHOTOS["c.jpg"]]) == {}
    assert pool.detected == [PHOTOS["c.jpg"]]
    assert told(database, job).strikes == 0


@pytest.mark.parametrize("failure", ["truncated", TimedOut("too slow"), WorkerCrashed("it died")])
def test_one_bad_photograph_does_not_end_the_build(database: Database, failure: object) -> None:
    job = running_job(database)

    def answer(task: Any) -> Any:
        if isinstance(task, DetectTask) and task.sha256 == PHOTOS["a.jpg"]:
            if isinstance(failure, Exception):
                raise failure
            return failure
        return None

    builder, pool = builder_of(database, answer)
    reason = failure.detail if isinstance(failure, (TimedOut, WorkerCrashed)) else str(failure)
    reasons = builder.detect(job.run, [PHOTOS["a.jpg"], PHOTOS["c.jpg"]])
    assert reasons == {PHOTOS["a.jpg"]: reason}
    builder.adjust_and_publish(job.run, reasons)
    assert pool.adjusted == [AdjustTask(job.run, (Unreadable("a.jpg", reason), Unreadable("twin of a.jpg", reason)))]


@pytest.mark.parametrize("kind", [DetectTask, AdjustTask])
def test_work_whose_process_was_killed_once_is_done_again(database: Database, kind: type) -> None:
    deaths = iter([WorkerCrashed("somebody killed it")])

    def answer(task: Any) -> Any:
        for death in deaths if isinstance(task, kind) else ():
            raise death
        return None

    job = running_job(database)
    builder, pool = builder_of(database, answer)
    assert builder.detect(job.run, [PHOTOS["a.jpg"]]) == {}
    builder.adjust_and_publish(job.run, {})
    assert len([task for task in pool.tasks if isinstance(task, kind)]) == 2


def test_what_the_adjustment_raises_ends_the_build(database: Database) -> None:
    def answer(_task: Any) -> Any:
        raise SurveyFailed("no overlap", reason="no-overlap")

    builder, _ = builder_of(database, answer)
    with pytest.raises(SurveyFailed, match="no overlap"):
        builder.adjust_and_publish(running_job(database).run, {})


def test_photographs_are_counted_whoever_detects_them(database: Database) -> None:
    job = running_job(database)
    builder, _ = builder_of(database)
    seen: list[tuple[str, int, int]] = []
    another = iter(["b.jpg", "a.jpg"])

    def detecting() -> bool:
        now = told(database, job)
        seen.append((now.stage, now.done, now.total))
        for name in another:
            keep_detection(database, name)
            return True
        return len(seen) < 4  # c.jpg cannot be used: it stays missing until the chunks are done

    builder.await_detection(job.run, detecting)
    assert seen == [("queued", 0, 0), ("detect", 1, 3), ("detect", 2, 3), ("detect", 2, 3)]
    assert (told(database, job).stage, told(database, job).done, told(database, job).total) == ("detect", 3, 3)


def test_what_is_under_way_ends_with_its_attempt(database: Database) -> None:
    job, other = running_job(database), running_job(database)
    builder, pool = builder_of(database, lambda _task: NEVER)
    raised: list[BaseException] = []

    def adjust() -> None:
        try:
            builder.adjust_and_publish(job.run, {})
        except Cancelled as error:
            raised.append(error)

    thread = threading.Thread(target=adjust)
    thread.start()
    pool.began.wait()
    while builder.tasks.runs != {job.run}:
        pass
    builder.tasks.end(other.run)
    assert builder.tasks.runs == {job.run}
    builder.tasks.end(job.run)
    thread.join()
    assert len(raised) == 1
    assert builder.tasks.runs == frozenset()


@pytest.mark.parametrize("attempt", [1, 2])
def test_a_step_of_an_attempt_that_is_over_does_nothing(database: Database, attempt: int) -> None:
    job = running_job(database)
    if attempt == 1:
        with database.writing() as session:
            JobRepository(session).cancel(job.job_id)
    run = JobRun(job.job_id, attempt)
    builder, pool = builder_of(database)
    for step in (
        lambda: builder.detect(run, [PHOTOS["a.jpg"]]),
        lambda: builder.await_detection(run, lambda: True),
        lambda: builder.adjust_and_publish(run, {}),
    ):
        with pytest.raises(Cancelled):
            step()
    assert pool.tasks == []


def test_a_cancelled_job_publishes_nothing_even_at_the_last_moment(database: Database) -> None:
    job = running_job(database)
    with database.reading() as session:
        material = adjust_work._gather(session, AdjustTask(job.run, ()))
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
        material = adjust_work._gather(session, AdjustTask(job.run, ()))
    version = adjust_work._publish(database, material, examples.publication(job.job_id, job.survey_id))
    with database.reading() as session:
        assert TargetMapRepository(session).version(job.site_id, None).version == version == 1
    done = told(database, job)
    expected = {"map_version": 1, "targets": len(examples.CODES), "photographs": 2, "unoriented": 1}
    assert (done.state, done.result) == ("succeeded", expected)
    with pytest.raises(Cancelled):  # the commit came through and its answer did not: nothing is published twice
        adjust_work._publish(database, material, examples.publication(job.job_id, job.survey_id))
    with database.reading() as session, pytest.raises(Exception, match="no target map version 2"):
        TargetMapRepository(session).load(job.site_id, 2)


class Away:
    """A database that gives no answer a few times."""

    def __init__(self, database: Database, times: int) -> None:
        self._database = database
        self._left = times

    @contextmanager
    def writing(self) -> Any:
        if self._left:
            self._left -= 1
            raise StorageUnavailable("the database gave no answer")
        with self._database.writing() as session:
            yield session


def test_a_publication_waits_for_a_database_that_is_away(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(write_patiently, "PAUSES_S", (0.0, 0.0))
    job = running_job(database)
    with database.reading() as session:
        material = adjust_work._gather(session, AdjustTask(job.run, ()))
    publication = examples.publication(job.job_id, job.survey_id)

    def published_by(away: Away) -> int:
        return write_patiently.write_patiently(
            job.job_id,
            lambda: adjust_work._publish(away, material, publication),  # type: ignore[arg-type]
        )

    with pytest.raises(StorageUnavailable):
        published_by(Away(database, 3))
    assert published_by(Away(database, 2)) == 1


def test_progress_that_cannot_be_written_ends_no_work(database: Database) -> None:
    job = running_job(database)
    progress = JobProgress(Away(database, 1), job.run)  # type: ignore[arg-type]
    progress.report("network", 0, 1)
    progress.report("adjust", 0, 1)
    assert told(database, job).stage == "adjust"


def test_progress_is_written_at_new_stages_and_ends_and_seldom_between(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = running_job(database)
    written: list[tuple[str, int]] = []
    original = JobRepository.progress

    def progress(self: JobRepository, run: JobRun, stage: str, done: int, total: int) -> bool:
        written.append((stage, done))
        return original(self, run, stage, done, total)

    monkeypatch.setattr(JobRepository, "progress", progress)
    monkeypatch.setattr("app.services.job_progress.WRITE_INTERVAL_S", 1e6)
    watcher = JobProgress(database, job.run)
    for stage in ("detect", "network"):
        for done in range(5):
            watcher.report(stage, done, 4)
    assert written == [("detect", 0), ("detect", 4), ("network", 0), ("network", 4)]
