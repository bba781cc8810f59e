"""What a dead worker had goes on elsewhere, once; a job that kills its workers does not go on for ever."""

from __future__ import annotations

import pytest

from app.jobs.engine import LeftBehind
from app.jobs.reaper import STRIKES_BORNE, Reaper
from app.storage.database import Database
from app.storage.job_queue import JobQueue
from app.storage.jobs import Job, JobRepository
from app.storage.workers import Worker, WorkerRepository
from tests.jobs.engine_stand_in import StandIn
from tests.storage.test_jobs import new_job, state


def signed_up(database: Database, slot: str = "a") -> Worker:
    with database.writing() as session:
        worker_id = WorkerRepository(session).add("host/0", slot)
    with database.reading() as session:
        return next(one for one in WorkerRepository(session).workers() if one.worker_id == worker_id)


def running_in(database: Database, worker: Worker) -> Job:
    job = new_job(database)
    with database.writing() as session:
        JobQueue(session).claim(job.run, worker.worker_id)
    return job


def workers(database: Database) -> list[str]:
    with database.reading() as session:
        return [worker.worker_id for worker in WorkerRepository(session).workers()]


def test_a_dead_workers_build_waits_for_another(database: Database) -> None:
    dead, engine = signed_up(database), StandIn()
    job = running_in(database, dead)
    Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    assert (state(database, job.job_id).state, state(database, job.job_id).strikes) == ("queued", 1)
    assert workers(database) == []


def test_a_build_that_it_had_just_been_given_waits_too(database: Database) -> None:
    dead, other, engine = signed_up(database), signed_up(database, "b"), StandIn()
    job = running_in(database, other)  # by the table; the engine had handed it on
    engine.left[dead.worker_id] = LeftBehind(frozenset({job.run}), {})
    Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    assert state(database, job.job_id).state == "queued"
    assert workers(database) == [other.worker_id]


def test_its_chunks_are_done_by_others_and_the_build_stays_where_it_is(database: Database) -> None:
    dead, other, engine = signed_up(database), signed_up(database, "b"), StandIn()
    job, cancelled = running_in(database, other), running_in(database, other)
    with database.writing() as session:
        JobRepository(session).cancel(cancelled.job_id)
    engine.left[dead.worker_id] = LeftBehind(frozenset(), {"a-1": job.run, "a-2": job.run, "b-1": cancelled.run})
    Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    assert engine.resumed_chunks == ["a-1", "a-2"]
    assert engine.cancelled == [cancelled.run]
    assert (state(database, job.job_id).state, state(database, job.job_id).owner) == ("running", other.worker_id)
    assert state(database, job.job_id).strikes == 1


def test_who_comes_second_does_nothing(database: Database) -> None:
    dead, engine = signed_up(database), StandIn()
    job = running_in(database, dead)
    Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    with database.writing() as session:
        JobQueue(session).claim(job.run, "another")
    Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    assert (state(database, job.job_id).state, state(database, job.job_id).owner) == ("running", "another")


def test_a_reaper_that_dies_over_it_leaves_it_to_the_next(database: Database) -> None:
    dead, engine = signed_up(database), StandIn()
    job = running_in(database, dead)

    class Dying(StandIn):
        def left_behind(self, worker_id: str) -> LeftBehind:
            raise KeyboardInterrupt(worker_id)

    with pytest.raises(KeyboardInterrupt):
        Reaper(database, Dying()).reap(dead)  # type: ignore[arg-type]
    assert workers(database) == [dead.worker_id]
    Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    assert state(database, job.job_id).state == "queued"


def test_a_job_that_kills_its_workers_fails_in_the_end_and_says_so(database: Database) -> None:
    engine, job = StandIn(), new_job(database)
    for _ in range(STRIKES_BORNE + 1):
        dead = signed_up(database)
        with database.writing() as session:
            assert JobQueue(session).claim(job.run, dead.worker_id)
        engine.left[dead.worker_id] = LeftBehind(frozenset({job.run}), {"chunk": job.run})
        Reaper(database, engine).reap(dead)  # type: ignore[arg-type]
    failed = state(database, job.job_id)
    assert failed.state == "failed"
    assert failed.error is not None
    assert failed.error["slug"] == "job-kills-workers"
    assert "split the survey" in failed.error["detail"]
    assert engine.cancelled == [job.run]
    assert len(engine.resumed_chunks) == STRIKES_BORNE


def test_who_left_in_order_was_not_killed_by_its_jobs(database: Database) -> None:
    engine, job = StandIn(), new_job(database)
    for _ in range(STRIKES_BORNE + 3):
        leaving = signed_up(database)
        with database.writing() as session:
            assert JobQueue(session).claim(job.run, leaving.worker_id)
            WorkerRepository(session).leave(leaving.worker_id)
        with database.reading() as session:
            (left,) = WorkerRepository(session).workers()
        Reaper(database, engine).reap(left)  # type: ignore[arg-type]
    assert (state(database, job.job_id).state, state(database, job.job_id).strikes) == ("queued", 0)
