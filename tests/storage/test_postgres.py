"""What SQLite, whose writers take turns, cannot let happen: two writers at the same time, over one row's parents."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

import pytest
from sqlalchemy import text

from app.errors import Conflict
from app.services.sites import delete_site
from app.storage.database import Database, StorageUnavailable
from app.storage.jobs import JobRepository
from app.storage.migrate import up_to_date, upgrade
from app.storage.sites import SiteRepository, find_site_row
from tests.databases import PostgresDatabases
from tests.storage.examples import site_with_survey

WAITS_FOR_A_LOCK = (
    "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND wait_event_type = 'Lock'"
)


@pytest.fixture
def database(postgresql: PostgresDatabases) -> Iterator[Database]:
    url = postgresql.migrated()
    opened = Database(url)
    yield opened
    opened.close()
    postgresql.take_back(url)


class InBackground:
    """Work in a thread of its own and what became of it."""

    def __init__(self, work: Callable[[], object]) -> None:
        self.error: Exception | None = None
        self._work = work
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def join(self) -> None:
        self._thread.join()

    def _run(self) -> None:
        try:
            self._work()
        except Exception as error:  # noqa: BLE001 - the test looks at it
            self.error = error


def wait_until_one_waits(database: Database) -> None:
    waiting = 0
    while not waiting:
        with database.reading() as session:
            waiting = session.execute(text(WAITS_FOR_A_LOCK)).scalar_one()


def test_a_row_that_is_locked_is_read_anew(database: Database) -> None:
    site, _ = site_with_survey(database)
    with database.writing() as session:
        assert find_site_row(session, site.site_id).name == "room"
        with database.writing() as other:
            SiteRepository(other).rename(site.site_id, "hall")
        assert find_site_row(session, site.site_id, lock=True).name == "hall"


def test_what_belongs_to_a_removed_site_is_a_conflict(database: Database) -> None:
    site, survey_id = site_with_survey(database)

    def ask_for_a_build_of_what_goes_away() -> None:
        with database.writing() as session:
            SiteRepository(session).get(site.site_id)
            with database.writing() as other:
                SiteRepository(other).delete(site.site_id)
            JobRepository(session).add("build", site.site_id, survey_id, {})

    with pytest.raises(Conflict, match="removed in the meantime"):
        ask_for_a_build_of_what_goes_away()


def test_a_site_is_not_removed_under_a_build_that_is_just_asked_for(database: Database) -> None:
    site, survey_id = site_with_survey(database)

    def remove() -> None:
        with database.writing() as session:
            delete_site(session, site.site_id)

    with database.writing() as session:
        JobRepository(session).add("build", site.site_id, survey_id, {})
        removing = InBackground(remove)
        wait_until_one_waits(database)
    removing.join()
    assert isinstance(removing.error, Conflict)
    with database.reading() as session:
        assert SiteRepository(session).get(site.site_id) == site


def test_two_that_start_at_once_migrate_once(postgresql: PostgresDatabases) -> None:
    url = postgresql.empty()
    databases = [Database(url) for _ in range(2)]
    upgrades = [InBackground(lambda database=database: upgrade(database)) for database in databases]  # type: ignore[misc]
    for running in upgrades:
        running.join()
    assert [running.error for running in upgrades] == [None, None]
    assert up_to_date(databases[0])
    for database in databases:
        database.close()
    postgresql.take_back(url)


def test_a_server_that_is_not_there_is_said_so() -> None:
    database = Database("postgresql://nobody@127.0.0.1:1/nothing")
    with pytest.raises(StorageUnavailable, match="no answer"):
        database.ping()
    database.close()
