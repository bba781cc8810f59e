"""Transactions: nothing lost, nothing half-written, readers harmless."""

from __future__ import annotations

import math
import subprocess
import sys
import textwrap
import threading

import pytest
from sqlalchemy.exc import DBAPIError, StatementError

from app.errors import NotFound
from app.storage import engines
from app.storage.database import Database, StorageUnavailable
from app.storage.jobs import JobRepository
from app.storage.models import SiteRow
from app.storage.sites import SiteRepository, find_site_row
from tests.storage import examples

THREADS, PROCESSES, STEPS = 6, 2, 25

# Read, then write what was read: under the driver's default transactions most of these are lost.
COUNT_UP = """
    import sys
    from app.storage.database import Database
    from app.storage.models import SiteRow
    database = Database(sys.argv[1])
    for _ in range(int(sys.argv[3])):
        with database.writing() as session:
            row = session.get(SiteRow, sys.argv[2], with_for_update=True)
            row.last_version = row.last_version + 1
    database.close()
"""


def new_site(database: Database) -> str:
    with database.writing() as session:
        return SiteRepository(session).add("room", "golay", 0.014, None).site_id


def last_version(database: Database, site_id: str) -> int:
    with database.reading() as session:
        row = session.get(SiteRow, site_id)
        assert row is not None
        return int(row.last_version)


def test_no_update_is_lost_between_threads_and_processes(database: Database) -> None:
    site_id = new_site(database)
    script = [sys.executable, "-c", textwrap.dedent(COUNT_UP), database.url, site_id, str(STEPS)]
    processes = [subprocess.Popen(script) for _ in range(PROCESSES)]

    def count_up() -> None:
        for _ in range(STEPS):
            with database.writing() as session:
                row = session.get(SiteRow, site_id, with_for_update=True)
                assert row is not None
                row.last_version = row.last_version + 1

    threads = [threading.Thread(target=count_up) for _ in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [process.wait() for process in processes] == [0] * PROCESSES
    assert last_version(database, site_id) == (THREADS + PROCESSES) * STEPS


def test_what_raises_is_undone(database: Database) -> None:
    made: list[str] = []

    def break_off() -> None:
        with database.writing() as session:
            made.append(SiteRepository(session).add("room", "golay", 0.014, None).site_id)
            raise RuntimeError("half-way")

    with pytest.raises(RuntimeError, match="half-way"):
        break_off()
    with pytest.raises(NotFound), database.reading() as session:
        SiteRepository(session).get(made[0])


def test_a_reader_cannot_write(database: Database) -> None:
    with pytest.raises((StorageUnavailable, DBAPIError), match=r"readonly|read-only"), database.reading() as session:
        SiteRepository(session).add("room", "golay", 0.014, None)


def test_a_lock_that_is_never_given_up_is_said_so(database_url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "BUSY_TIMEOUT_MS", 20)
    first, second = Database(database_url), Database(database_url)
    try:
        site_id = new_site(first)
        with first.writing() as held:
            find_site_row(held, site_id, lock=True)
            with pytest.raises(StorageUnavailable, match="lock") as refused, second.writing() as session:
                find_site_row(session, site_id, lock=True)
        assert refused.value.fields["retry_after_s"] >= 1
    finally:
        first.close()
        second.close()


def test_a_number_that_json_does_not_have_is_refused(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    with pytest.raises((ValueError, StatementError), match="not JSON"), database.writing() as session:
        JobRepository(session).add("build", site.site_id, survey_id, {"weight": math.nan})


def test_a_reader_sees_one_state_while_others_write(database: Database) -> None:
    site_id = new_site(database)
    with database.reading() as reader:
        before = SiteRepository(reader).get(site_id)
        with database.writing() as writer:
            SiteRepository(writer).rename(site_id, "another name")
        reader.expire_all()
        assert SiteRepository(reader).get(site_id) == before
    with database.reading() as reader:
        assert SiteRepository(reader).get(site_id).name == "another name"
