"""Workers in the database: they count, by the database's clock."""

from __future__ import annotations

import time

import pytest
from sqlalchemy import update

from app.storage.database import Database
from app.storage.models import WorkerRow
from app.storage.workers import LIVE_S, Worker, WorkerRepository


def only(database: Database) -> Worker:
    with database.reading() as session:
        (worker,) = WorkerRepository(session).workers()
    return worker


def test_a_worker_beats_and_leaves(database: Database) -> None:
    with database.writing() as session:
        worker_id = WorkerRepository(session).add("host/0", "host/0/abc")
    assert (only(database).name, only(database).slot, only(database).beats) == ("host/0", "host/0/abc", 0)
    with database.writing() as session:
        assert WorkerRepository(session).beat(worker_id)
    assert (only(database).beats, only(database).live) == (1, True)
    with database.writing() as session:
        WorkerRepository(session).leave(worker_id)
    assert (only(database).left, only(database).live) == (True, False)
    with database.writing() as session:
        workers = WorkerRepository(session)
        assert workers.lock(worker_id)
        workers.remove(worker_id)
        assert not workers.lock(worker_id)
        assert not workers.beat(worker_id)  # so it learns that it was given up
        assert workers.live_workers() == ()


def test_age_is_by_the_databases_clock_whatever_ours_says(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "time", lambda: 0.0)
    with database.writing() as session:
        worker_id = WorkerRepository(session).add("host/0", "host/0/abc")
        assert [worker.live for worker in WorkerRepository(session).live_workers()] == [True]
        silent = update(WorkerRow).where(WorkerRow.id == worker_id).values(beat_s=WorkerRow.beat_s - 3 * LIVE_S)
        session.execute(silent)
    assert not only(database).live
    assert only(database).age_s >= 3 * LIVE_S
