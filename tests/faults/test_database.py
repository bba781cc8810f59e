"""A database that is gone and comes back, or that somebody else holds: refusals meanwhile, nothing lost afterwards."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest
from sqlalchemy import make_url

from app.settings import Settings
from app.storage import engines
from tests.api.serving import PROBLEM_TYPE, room_photos, serve
from tests.databases import migrated, postgres_instance
from tests.faults.ledger import Ledger, wait_until

BUSY_MS = 300
PHOTOS = list(room_photos("survey").items())
HOLD = """
import sqlite3, sys
connection = sqlite3.connect(sys.argv[1], isolation_level=None)
connection.execute("BEGIN IMMEDIATE")
print("held", flush=True)
sys.stdin.read()
"""


class Work:
    """Photographs and snapshots without a pause, from a thread each, until the block ends."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger
        self._ended = threading.Event()
        self._threads = [threading.Thread(target=self._repeat, args=(work,)) for work in (self._upload, ledger.locate)]
        self._count = 0
        self.statuses: list[int] = []

    def _upload(self) -> httpx.Response:
        name, data = PHOTOS[self._count % len(PHOTOS)]
        self._count += 1
        return self._ledger.upload(f"{self._count}-{name}", data)

    def _repeat(self, work: Callable[[], httpx.Response]) -> None:
        while not self._ended.is_set():
            answer = work()
            assert answer.is_success or answer.headers["content-type"] == PROBLEM_TYPE
            self.statuses.append(answer.status_code)

    def await_status(self, *wanted: int) -> None:
        """Wait until an answer from now on has one of these statuses."""
        begin = len(self.statuses)
        wait_until(lambda: bool(set(wanted) & set(self.statuses[begin:])), f"no answer was any of {wanted}")

    def __enter__(self) -> Work:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        for thread in self._threads:
            thread.join()


def settings_in(folder: Path, **changes: Any) -> Settings:
    return replace(Settings(data_dir=folder, locate_workers=1, build_workers=1), **changes)


def is_refused_alive(ledger: Ledger) -> None:
    """The service answers that it is not ready, and says what is wrong."""
    assert ledger.served.client.get("/healthz").status_code == 200
    ready = ledger.served.client.get("/readyz")
    assert ready.status_code == 503
    assert ready.json()["checks"]["database"] != "ok"


# Postgres


@pytest.fixture(scope="module")
def postgres() -> Iterator[Any]:
    with postgres_instance() as server:
        yield server


@pytest.fixture(scope="module")
def on_postgres(postgres: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ledger]:
    settings = settings_in(tmp_path_factory.mktemp("postgres"), database_url=migrated(postgres.get_uri()))
    with serve(settings, worker=False) as running, closing(Ledger(running)) as kept:
        yield kept


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGQUIT], ids=lambda how: how.name)
def test_a_postgres_that_stops_and_starts_costs_the_requests_between(
    postgres: Any, on_postgres: Ledger, how: signal.Signals
) -> None:
    with Work(on_postgres) as work:
        work.await_status(200, 201)
        pid = postgres.get_pid()
        os.kill(pid, how)
        work.await_status(503)
        wait_until(lambda: not _runs(pid), "Postgres runs on")
        is_refused_alive(on_postgres)
        wait_until(lambda: _started(postgres), "Postgres does not start")
        work.await_status(200)
        work.await_status(201)
    assert set(work.statuses) <= {200, 201, 503}
    on_postgres.check()


def _runs(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return "Z" not in Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


def _started(postgres: Any) -> bool:
    try:
        postgres.start()
    except subprocess.SubprocessError:  # processes of the one before are still about to end
        return False
    return True


# SQLite


@pytest.fixture(scope="module")
def on_sqlite(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ledger]:
    with pytest.MonkeyPatch.context() as patience:
        patience.setattr(engines, "BUSY_TIMEOUT_MS", BUSY_MS)
        settings = settings_in(tmp_path_factory.mktemp("sqlite"))
        with serve(settings, worker=False) as running, closing(Ledger(running)) as kept:
            yield kept


@contextmanager
def held(ledger: Ledger) -> Iterator[None]:
    """Another process has the write lock of the database, as a backup tool or a person at a prompt may."""
    path = str(make_url(ledger.served.settings.sqlalchemy_url).database)
    holder = subprocess.Popen([sys.executable, "-c", HOLD, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert holder.stdout is not None
    assert holder.stdout.readline() == b"held\n"
    yield
    holder.communicate()


def test_a_database_that_another_process_holds_costs_the_writes_meanwhile(on_sqlite: Ledger) -> None:
    with Work(on_sqlite) as work:
        work.await_status(200, 201)
        with held(on_sqlite):
            work.await_status(503)
            work.await_status(503)
            assert on_sqlite.served.client.get(f"/sites/{on_sqlite.site_id}").status_code == 200  # readers go on
            refused = on_sqlite.served.client.post("/sites", json={"name": "later"})
            assert refused.status_code == 503
            assert int(refused.headers["Retry-After"]) >= 1
        work.await_status(200)
        work.await_status(201)
    assert set(work.statuses) <= {200, 201, 503}
    on_sqlite.check()
