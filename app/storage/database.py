"""The database: sessions for writers, for pose rows and for readers, each committed once, at the edge."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from sqlalchemy import Connection, QueuePool, text
from sqlalchemy.exc import DBAPIError, IntegrityError, OperationalError
from sqlalchemy.exc import TimeoutError as NoConnectionLeft
from sqlalchemy.orm import Session as Session

from app.errors import Conflict, OutOfSpace
from app.errors import StorageUnavailable as StorageUnavailable
from app.storage.audit import signing
from app.storage.engines import Access, engine_for

Answer = TypeVar("Answer")

RETRY_AFTER_S = 1
FOREIGN_KEY_VIOLATION = "23503"  # SQLSTATE
POSTGRES_DISK_FULL = "53100"  # SQLSTATE
MIGRATION_LOCK = 0x5CA77E12  # of Postgres's advisory locks; any number that no other program takes


class Database:
    """Sessions for threads and processes; engines connect when first used.

    Parameters
    ----------
    url : str
        SQLAlchemy URL of SQLite (a file) or Postgres.
    """

    def __init__(self, url: str) -> None:
        self.url = url
        self.writer = engine_for(url, Access.WRITE)
        self.recorder = engine_for(url, Access.RECORD)
        self.reader = engine_for(url, Access.READ)
        self.looker = engine_for(url, Access.LOOK)

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """A session whose work is committed as a whole when the block ends, and undone when it raises.

        Whoever acts (``app.storage.audit``) stands in the audit for it.

        Raises
        ------
        StorageUnavailable
            When the database stays locked or is gone.
        """
        with (
            _translated(),
            Session(self.writer, expire_on_commit=False) as session,
            session.begin(),
            signing(session),
        ):
            yield session

    @contextmanager
    def recording(self) -> Iterator[Session]:
        """``writing`` for poses, many a second: when the database's machine falls, the last of them may be lost.

        Raises
        ------
        StorageUnavailable
            When the database stays locked or is gone.
        """
        with _translated(), Session(self.recorder, expire_on_commit=False) as session, session.begin():
            yield session

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """A session that sees one state of the database and cannot change it.

        Raises
        ------
        StorageUnavailable
            When the database stays locked or is gone.
        """
        with _translated(), Session(self.reader) as session:
            yield session

    @contextmanager
    def recording_rows(self) -> Iterator[Connection]:
        """``recording`` without a session, whose bookkeeping would take a good part of a row's time."""
        with _translated(), self.recorder.begin() as connection:
            yield connection

    def look(self, ask: Callable[[Connection], Answer]) -> Answer:
        """Ask one question outside of any transaction; once more when the connection turns out to be dead.

        Raises
        ------
        StorageUnavailable
            When the database stays locked or is gone.
        """
        with _translated():
            try:
                with self.looker.connect() as connection:
                    return ask(connection)
            except DBAPIError as error:
                if not error.connection_invalidated:
                    raise
            with self.looker.connect() as connection:
                return ask(connection)

    @contextmanager
    def migrating(self) -> Iterator[Connection]:
        """A connection for changing tables, committed when the block ends; one process at a time has it.

        Foreign keys are not enforced on SQLite meanwhile: it alters a table by copying and dropping it, and the drop
        would delete the rows that refer to it.
        """
        with _translated(), self.writer.connect() as connection:
            _enforce_foreign_keys(connection, False)
            try:
                with connection.begin():
                    _wait_for_other_migrations(connection)
                    yield connection
            finally:
                _enforce_foreign_keys(connection, True)

    def ping(self) -> None:
        """Ask the database for an answer.

        Raises
        ------
        StorageUnavailable
            When it gives none.
        """
        with self.reading() as session:
            session.execute(text("SELECT 1"))

    def connections(self) -> dict[str, tuple[int, int]]:
        """Open connections of this process by what their sessions do: how many are in use, how many idle."""
        engines = {
            Access.WRITE: self.writer,
            Access.RECORD: self.recorder,
            Access.READ: self.reader,
            Access.LOOK: self.looker,
        }
        pools = {access: engine.pool for access, engine in engines.items() if isinstance(engine.pool, QueuePool)}
        return {access.value: (pool.checkedout(), pool.checkedin()) for access, pool in pools.items()}

    def close(self) -> None:
        """Let go of all connections."""
        self.writer.dispose()
        self.recorder.dispose()
        self.reader.dispose()
        self.looker.dispose()


@contextmanager
def _translated() -> Iterator[None]:
    try:
        yield
    except (OperationalError, NoConnectionLeft) as error:
        cause = error.orig if isinstance(error, OperationalError) else error
        if _is_full(cause):
            raise OutOfSpace(
                "the database's disk is full; make room on it (`scattermark purge` removes what nothing refers to), "
                "then send the request again"
            ) from error
        raise StorageUnavailable(
            f"the database gave no answer ({cause}); send the request again, and look at /readyz if it stays so",
            retry_after_s=RETRY_AFTER_S,
        ) from error
    except IntegrityError as error:
        if getattr(error.orig, "sqlstate", None) != FOREIGN_KEY_VIOLATION:
            raise
        raise Conflict(
            "what this belongs to was removed in the meantime; read it again and start from there"
        ) from error


def _is_full(cause: object) -> bool:
    """Whether the database could not write for want of room."""
    on_sqlite = getattr(cause, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL
    return on_sqlite or getattr(cause, "sqlstate", None) == POSTGRES_DISK_FULL


def _wait_for_other_migrations(connection: Connection) -> None:
    """SQLite's writer is alone already."""
    if connection.dialect.name == "postgresql":
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": MIGRATION_LOCK})


def _enforce_foreign_keys(connection: Connection, wanted: bool) -> None:
    """SQLite's switch; it acts outside a transaction only, so it goes to the driver's connection."""
    if connection.dialect.name == "sqlite":
        driver: Any = connection.connection.dbapi_connection
        driver.execute(f"PRAGMA foreign_keys={'ON' if wanted else 'OFF'}")
