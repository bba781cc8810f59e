"""A worker's own page for Prometheus: its pool and how long the steps of builds take."""

from __future__ import annotations

import socket

import httpx
import pytest

from app.errors import InvalidInput
from app.jobs.pool import WorkerPool
from app.jobs.worker_metrics import metrics_served
from app.storage.database import Database
from tests.api.metrics_reading import Scrape
from tests.databases import SqliteDatabases
from tests.jobs import pool_work

ANSWER_S = 60.0


@pytest.fixture
def port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


def test_a_worker_is_scraped_while_it_works(sqlite: SqliteDatabases, port: int) -> None:
    database = Database(sqlite.migrated())
    labels = {"pool": "build", "task": "double"}
    with WorkerPool(workers=1, queue_depth=1) as pool, metrics_served(port, pool, database):
        assert pool.submit(pool_work.double, 21).result(ANSWER_S) == 42
        shown = Scrape(httpx.get(f"http://127.0.0.1:{port}/metrics", timeout=ANSWER_S).text)
    assert shown.value("scattermark_pool_workers", pool="build") == 1
    assert shown.value("scattermark_pool_task_duration_seconds_count", **labels) == 1
    assert shown.value("scattermark_pool_task_wait_seconds_count", **labels) == 1
    with pytest.raises(httpx.ConnectError):
        httpx.get(f"http://127.0.0.1:{port}/metrics", timeout=ANSWER_S)
    database.close()


def test_a_taken_port_is_named(sqlite: SqliteDatabases) -> None:
    database, pool = Database(sqlite.migrated()), WorkerPool(1, 1)
    with socket.create_server(("", 0)) as taken:
        number = taken.getsockname()[1]
        with (
            pytest.raises(InvalidInput, match=f"SCATTERMARK_WORKER_METRICS_PORT={number}"),
            metrics_served(number, pool, database),
        ):
            pass
    database.close()


def test_without_a_port_nothing_listens(sqlite: SqliteDatabases) -> None:
    database = Database(sqlite.migrated())
    pool = WorkerPool(1, 1)
    with metrics_served(0, pool, database):
        assert pool.on_done is None
    database.close()
