"""The database: engines for writers and for readers, and a session that commits once at the edge.

SQLite loses updates under its driver's default transactions, so a writer takes the write lock when it begins
(``BEGIN IMMEDIATE``) and a reader cannot write at all.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session as Session

from app.errors import ScattermarkError

BUSY_TIMEOUT_MS = 10_000  # a writer's turn: transactions here take milliseconds, a publication some tenths of a second
RETRY_AFTER_S = 1


class StorageUnavailable(ScattermarkError):
    """The database is locked for too long or cannot be reached."""

    slug = "storage-unavailable"


class Database:
    """Sessions for threads and processes; engines connect when first used.

    Parameters
    ----------
    url : str
        SQLAlchemy URL of SQLite (a file) or Postgres.
    """

    def __init__(self, url: str) -> None:
        self.url = url
        self.writer = _engine(url, read_only=False)
        self.recorder = _engine(url, read_only=False, synchronous="NORMAL")
        self.reader = _engine(url, read_only=True)

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """A session whose work is committed as a whole when the block ends, and undone when it raises.

        Raises
        ------
        StorageUnavailable
            When the database stays locked or is gone.
        """
        with _translated(), Session(self.writer, expire_on_commit=False) as session, session.begin():
            yield session

    @contextmanager
    def recording(self) -> Iterator[Session]:
        """``writing`` for poses, many a second: on SQLite a power cut may lose the last of them, and nothing else.

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
    def migrating(self) -> Iterator[Connection]:
        """A connection for changing tables, committed when the block ends.

        Foreign keys are not enforced on SQLite meanwhile: it alters a table by copying and dropping it, and the drop
        would delete the rows that refer to it.
        """
        with _translated(), self.writer.connect() as connection:
            _enforce_foreign_keys(connection, False)
            try:
                with connection.begin():
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

    def close(self) -> None:
        """Let go of all connections."""
        self.writer.dispose()
        self.recorder.dispose()
        self.reader.dispose()


@contextmanager
def _translated() -> Iterator[None]:
    try:
        yield
    except OperationalError as error:
        raise StorageUnavailable(
            f"the database gave no answer ({error.orig}); send the request again, and look at /readyz if it stays so",
            retry_after_s=RETRY_AFTER_S,
        ) from error


def _enforce_foreign_keys(connection: Connection, wanted: bool) -> None:
    """SQLite's switch; it acts outside a transaction only, so it goes to the driver's connection."""
    if connection.dialect.name == "sqlite":
        driver: Any = connection.connection.dbapi_connection
        driver.execute(f"PRAGMA foreign_keys={'ON' if wanted else 'OFF'}")


def _engine(url: str, *, read_only: bool, synchronous: str = "FULL") -> Engine:
    if not url.startswith("sqlite"):
        isolation = "REPEATABLE READ" if read_only else "READ COMMITTED"
        engine = create_engine(url, pool_pre_ping=True, isolation_level=isolation)
        return engine.execution_options(postgresql_readonly=read_only)
    engine = create_engine(url, connect_args={"timeout": BUSY_TIMEOUT_MS / 1000})
    begin = "BEGIN" if read_only else "BEGIN IMMEDIATE"

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, _record: Any) -> None:
        connection.isolation_level = None  # the driver shall begin nothing by itself
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute(f"PRAGMA synchronous={synchronous}")
        connection.execute("PRAGMA foreign_keys=ON")
        if read_only:
            connection.execute("PRAGMA query_only=ON")

    @event.listens_for(engine, "begin")
    def begin_transaction(connection: Connection) -> None:
        connection.exec_driver_sql(begin)

    return engine
