"""A worker's loop, turn by turn: it takes jobs, ends what was cancelled, mends what broke off, leaves when given up."""

from __future__ import annotations

from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from app.jobs import foreman as foreman_module
from app.jobs.engine import Known
from app.jobs.foreman import Foreman, GivenUp, Place
from app.jobs.lookout import LOOKS_BELIEVED
from app.services.build_tasks import BuildTasks
from app.storage.database import Database
from app.storage.jobs import JobRepository, JobRun
from app.storage.workers import WorkerRepository
from tests.jobs.engine_stand_in import StandIn
from tests.jobs.test_reaper import running_in, signed_up, workers
from tests.storage.test_jobs import new_job, state


@dataclass
class Builder:
    tasks: BuildTasks = field(default_factory=BuildTasks)


@dataclass
class Crew:
    """What the foreman looks at of the workflows' crew."""

    database: Database
    builder: Builder = field(default_factory=Builder)
    active: set[JobRun] = field(default_factory=set)


@pytest.fixture
def engine() -> StandIn:
    return StandIn()


@pytest.fixture
def crew(database: Database) -> Crew:
    return Crew(database)


@pytest.fixture
def foreman(database: Database, crew: Crew, engine: StandIn, monkeypatch: pytest.MonkeyPatch) -> Foreman:
    monkeypatch.setattr(foreman_module, "BEAT_INTERVAL_S", 0.0)  # each turn beats, looks and checks
    monkeypatch.setattr(foreman_module, "CHECK_INTERVAL_S", 0.0)
    me = signed_up(database, "mine")
    return Foreman(crew, engine, Place(me.worker_id, me.slot, builds=2))  # type: ignore[arg-type]


def test_as_many_jobs_are_taken_as_there_is_room_for(
    database: Database, foreman: Foreman, crew: Crew, engine: StandIn
) -> None:
    jobs = sorted((new_job(database) for _ in range(3)), key=lambda job: job.job_id)
    crew.active.add(jobs[0].run)
    foreman.turn()
    assert engine.started == [jobs[0].run]


def test_a_job_that_another_worker_began_goes_on(database: Database, foreman: Foreman, engine: StandIn) -> None:
    job = new_job(database)
    engine.knows[job.run] = Known.UNDER_WAY
    foreman.turn()
    assert (engine.started, engine.resumed) == ([], [job.run])


def test_a_job_whose_end_the_table_does_not_know_begins_anew(
    database: Database, foreman: Foreman, engine: StandIn
) -> None:
    job = new_job(database)
    engine.knows[job.run] = Known.ENDED
    foreman.turn()
    assert engine.started == [JobRun(job.job_id, 2)]
    assert state(database, job.job_id).attempt == 2


def test_a_claim_that_broke_off_is_mended_when_seen_twice(
    database: Database, foreman: Foreman, crew: Crew, engine: StandIn
) -> None:
    with database.reading() as session:
        (me,) = WorkerRepository(session).workers()
    job, busy = running_in(database, me), running_in(database, me)
    crew.active.add(busy.run)
    foreman.turn()
    assert engine.started == []
    foreman.turn()
    assert engine.started == [job.run]


def test_what_was_cancelled_is_ended_here_and_in_the_engine(
    database: Database, foreman: Foreman, crew: Crew, engine: StandIn
) -> None:
    with database.reading() as session:
        (me,) = WorkerRepository(session).workers()
    job, other = running_in(database, me), running_in(database, me)
    ended: list[JobRun] = []
    with ExitStack() as under_way:
        for run in (job.run, other.run):
            future: Future[Any] = Future()
            future.add_done_callback(lambda _future, run=run: ended.append(run))
            crew.active.add(run)
            under_way.enter_context(crew.builder.tasks.watching(run, future))
        with database.writing() as session:
            JobRepository(session).cancel(job.job_id)
        foreman.turn()
        foreman.turn()
    assert (ended, engine.cancelled) == ([job.run], [job.run])


def test_who_had_our_place_before_is_dead_at_the_first_look(database: Database, foreman: Foreman) -> None:
    before, other = signed_up(database, "mine"), signed_up(database, "another's")
    job = running_in(database, before)
    foreman.turn()
    assert before.worker_id not in workers(database)
    assert other.worker_id in workers(database)
    assert state(database, job.job_id).state == "running"  # taken in the same turn


def test_who_is_silent_is_dead_in_the_end(database: Database, foreman: Foreman) -> None:
    silent = signed_up(database, "another's")
    turns = 0
    while silent.worker_id in workers(database):
        foreman.turn()
        turns += 1
    assert turns == LOOKS_BELIEVED + 1


def test_who_was_given_up_ends(database: Database, foreman: Foreman) -> None:
    with database.writing() as session:
        (me,) = WorkerRepository(session).workers()
        WorkerRepository(session).remove(me.worker_id)
    with pytest.raises(GivenUp):
        foreman.turn()


def test_a_database_that_is_away_is_asked_again(
    database: Database, engine: StandIn, foreman: Foreman, tmp_path: Path
) -> None:
    job = new_job(database)
    there = foreman._database
    foreman._database = Database(f"sqlite:///{tmp_path / 'no folder' / 'x.db'}")
    foreman.turn()
    foreman._database = there
    foreman.turn()
    assert engine.started == [job.run]
