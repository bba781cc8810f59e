"""What needs a database and the same answer from every kind."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from app.storage.database import Database
from tests.databases import SqliteDatabases
from tests.storage.walks import Step, add_walk, new_site


@pytest.fixture
def sqlite_database(sqlite: SqliteDatabases) -> Iterator[Database]:
    database = Database(sqlite.migrated())
    yield database
    database.close()
    sqlite.take_back(database.url)


@pytest.fixture
def sqlite_walk(sqlite_database: Database) -> tuple[Database, str]:
    return sqlite_database, add_walk(sqlite_database, new_site(sqlite_database), [Step(0.0, (1.0, 2.0, 1.5))])
