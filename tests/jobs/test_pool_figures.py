"""What a pool tells of itself, and whose work its log lines speak of."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path

import pytest
from asgi_correlation_id import correlation_id

from app.errors import ServerFull, TimedOut, WorkerCrashed
from app.jobs.pool import WorkerPool
from app.logs import LogOptions, log_context, logging_with
from tests.jobs import pool_work
from tests.jobs.test_pool import ANSWER_S, until

SHORT_S = 0.05


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    with WorkerPool(workers=1, queue_depth=1) as running:
        yield running


def test_what_is_under_way_and_what_was_refused(pool: WorkerPool, tmp_path: Path) -> None:
    before = pool.figures
    assert (before.workers, before.busy, before.waiting) == (1, 0, 0)
    running = pool.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "release")
    until((tmp_path / "started").exists)
    waiting = pool.submit(pool_work.double, 1)
    with pytest.raises(ServerFull):
        pool.submit(pool_work.double, 2)
    assert (pool.figures.busy, pool.figures.waiting, pool.figures.refused - before.refused) == (1, 1, 1)
    (tmp_path / "release").touch()
    assert (running.result(ANSWER_S), waiting.result(ANSWER_S)) == ("released", 2)
    assert (pool.figures.busy, pool.figures.waiting) == (0, 0)


def test_what_workers_died_of_and_their_successors(pool: WorkerPool, caplog: pytest.LogCaptureFixture) -> None:
    before = pool.figures
    seen: list[object] = []

    class Watching(logging.Handler):
        def emit(self, _record: logging.LogRecord) -> None:
            seen.append(log_context().get("job_id"))

    watching = Watching()
    logging.getLogger("app.jobs.keeper").addHandler(watching)
    try:
        with logging_with({"job_id": "job-7"}):
            with pytest.raises(WorkerCrashed):
                pool.submit(pool_work.die).result(ANSWER_S)
            with pytest.raises(TimedOut):
                pool.submit(pool_work.hang, timeout_s=SHORT_S).result(ANSWER_S)
    finally:
        logging.getLogger("app.jobs.keeper").removeHandler(watching)
    assert pool.submit(pool_work.double, 2).result(ANSWER_S) == 4
    after = pool.figures
    assert (after.crashed - before.crashed, after.timed_out - before.timed_out) == (1, 1)
    assert after.started - before.started == 2
    assert seen == ["job-7", "job-7"]
    assert [record.task for record in caplog.records if record.name == "app.jobs.keeper"] == ["die", "hang"]  # type: ignore[attr-defined]


def test_each_piece_of_work_is_timed(pool: WorkerPool) -> None:
    done: list[tuple[str, float, float]] = []
    pool.on_done = lambda *what: done.append(what)
    pool.submit(pool_work.double, 2).result(ANSWER_S)
    pool.on_done = None
    ((name, waited_s, running_s),) = done
    assert name == "double" and waited_s >= 0.0 and running_s >= 0.0


def test_a_worker_logs_with_the_ids_of_whoever_asked_and_no_others(pool: WorkerPool) -> None:
    token = correlation_id.set("request-7")
    try:
        with logging_with({"job_id": "job-7"}):
            context, _ = pool.submit(pool_work.logs_with).result(ANSWER_S)
    finally:
        correlation_id.reset(token)
    assert context == {"request_id": "request-7", "job_id": "job-7"}
    assert pool.submit(pool_work.logs_with).result(ANSWER_S)[0] == {}


def test_a_worker_logs_as_its_parent_does(monkeypatch: pytest.MonkeyPatch) -> None:
    options = LogOptions("json", "warning")
    monkeypatch.setattr("app.logs._Process.options", options)
    with WorkerPool(workers=1, queue_depth=0) as pool:
        assert pool.submit(pool_work.logs_with).result(ANSWER_S)[1] == options
