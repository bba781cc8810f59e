"""Whatever is missing or hangs, the answer comes, and says which and what to do."""

from __future__ import annotations

import asyncio
import shutil
import socket
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from app.errors import StorageUnavailable
from app.jobs.pool import WorkerPool
from app.services.readiness import OK, Dependencies, Readiness, ReadinessReport
from app.storage.database import Database
from app.storage.migrate import downgrade
from app.storage.photo_store import open_photo_store
from tests.databases import SqliteDatabases

ENDLESS_BYTES = 2**62


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    with WorkerPool(workers=1, queue_depth=0) as running:
        yield running


@pytest.fixture
def sound(sqlite_database: Database, pool: WorkerPool, tmp_path: Path) -> Dependencies:
    photos = open_photo_store(str(tmp_path / "photographs"))
    return Dependencies(sqlite_database, photos, pool, min_free_bytes=1, live_workers=lambda: 1)


def look(on: Dependencies, *, leaving: bool = False) -> ReadinessReport:
    return asyncio.run(Readiness(on).look(leaving))


def failed(report: ReadinessReport) -> set[str]:
    return {name for name, outcome in report.checks.items() if outcome != OK}


def test_a_sound_server_is_ready(sound: Dependencies) -> None:
    report = look(sound)
    assert (report.status, report.takes_requests, failed(report)) == ("ready", True, set())
    assert set(report.checks) == {
        "database", "migrations", "photographs", "locate_workers", "serving", "disk", "builds",
    }  # fmt: skip


def test_a_server_that_leaves_is_not_ready(sound: Dependencies) -> None:
    report = look(sound, leaving=True)
    assert (report.status, report.takes_requests, failed(report)) == ("not ready", False, {"serving"})


def raise_unavailable() -> int:
    raise StorageUnavailable("the database gave no answer")


@pytest.mark.parametrize("live_workers", [lambda: 0, raise_unavailable])
def test_without_a_worker_snapshots_are_located_all_the_same(
    sound: Dependencies, live_workers: Callable[[], int]
) -> None:
    report = look(replace(sound, live_workers=live_workers))
    assert (report.status, report.takes_requests, failed(report)) == ("degraded", True, {"builds"})


def test_a_disk_that_takes_no_photographs_does_not_end_locating(sound: Dependencies) -> None:
    report = look(replace(sound, min_free_bytes=ENDLESS_BYTES))
    assert (report.status, failed(report)) == ("degraded", {"disk"})
    assert "SCATTERMARK_MIN_FREE_BYTES" in report.checks["disk"]


def test_photographs_that_cannot_be_written_make_it_not_ready(sound: Dependencies, tmp_path: Path) -> None:
    shutil.rmtree(tmp_path / "photographs")
    (tmp_path / "photographs").write_text("a file where a folder is needed")
    report = look(sound)
    assert report.status == "not ready" and "photographs" in failed(report)


def test_tables_of_another_release_make_it_not_ready(sqlite: SqliteDatabases, sound: Dependencies) -> None:
    database = Database(sqlite.migrated())
    downgrade(database, "0001")
    report = look(replace(sound, database=database))
    assert (report.status, failed(report)) == ("not ready", {"migrations"})
    assert "scattermark migrate" in report.checks["migrations"]
    database.close()


def test_a_pool_without_processes_makes_it_not_ready(sound: Dependencies) -> None:
    report = look(replace(sound, locating=WorkerPool(workers=1, queue_depth=0)))
    assert (report.status, failed(report)) == ("not ready", {"locate_workers"})


def test_a_database_that_says_nothing_costs_seconds(sound: Dependencies, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.services.readiness.PATIENCE_S", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as silent:  # it takes connections and never speaks
        port = silent.getsockname()[1]
        database = Database(f"postgresql+psycopg://nobody@127.0.0.1:{port}/nothing?connect_timeout=3")
        report = look(replace(sound, database=database))
        assert (report.status, failed(report)) == ("not ready", {"database", "migrations"})
        assert "no answer within 1 s" in report.checks["database"]
