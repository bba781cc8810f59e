"""Engines of SQLite and of Postgres that behave alike: no lost update, no reader that writes, no wait without end.

SQLite loses updates under its driver's default transactions, so a writer takes the write lock when it begins
(``BEGIN IMMEDIATE``). On Postgres writers meet at the rows that they lock.
"""

from __future__ import annotations

import json
from enum import Enum
from functools import partial
from typing import Any

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url
from sqlalchemy.engine.interfaces import IsolationLevel

BUSY_TIMEOUT_MS = 10_000  # a writer's turn: transactions here take milliseconds, a publication some tenths of a second
CONNECT_TIMEOUT_S = 10  # a database that is there answers within one; Postgres's own default is two minutes

# Postgres's JSON has no NaN. SQLite would take it, and the fault would show on the other database only.
STRICT_JSON = partial(json.dumps, allow_nan=False)


class Access(Enum):
    """What an engine's sessions do."""

    READ = "read"  # see one state of the database, change nothing
    WRITE = "write"  # on disk when committed
    LOOK = "look"  # one statement at a time, each seeing what is committed when it begins; no transaction around it
    RECORD = "record"  # safe from a process that dies, not from a power cut: many rows a second


POSTGRES_ISOLATION: dict[Access, IsolationLevel] = {
    Access.READ: "REPEATABLE READ",
    Access.LOOK: "AUTOCOMMIT",
    Access.WRITE: "READ COMMITTED",
    Access.RECORD: "READ COMMITTED",
}
SQLITE_BEGIN = {Access.READ: "BEGIN", Access.WRITE: "BEGIN IMMEDIATE", Access.RECORD: "BEGIN IMMEDIATE"}


def engine_for(address: str, access: Access) -> Engine:
    """An engine that connects when first used.

    Parameters
    ----------
    address : str
        SQLAlchemy URL of SQLite (a file) or Postgres.
    access : Access

    Raises
    ------
    sqlalchemy.exc.ArgumentError
        For what is no such URL.
    ModuleNotFoundError
        When the database's driver is not installed.
    """
    url = make_url(address)
    return _sqlite_engine(url, access) if url.get_backend_name() == "sqlite" else _postgres_engine(url, access)


def _postgres_engine(url: URL, access: Access) -> Engine:
    engine = create_engine(
        url.update_query_dict({"connect_timeout": str(CONNECT_TIMEOUT_S), **url.query}),
        pool_pre_ping=access is not Access.LOOK,  # it would take as long as the look
        isolation_level=POSTGRES_ISOLATION[access],
        json_serializer=STRICT_JSON,
    )

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, _record: Any) -> None:
        connection.execute(f"SET lock_timeout = {BUSY_TIMEOUT_MS}")
        # Poses wait for this machine's disk and for no standby: without the disk a server that crashes would lose what
        # was answered in the second before, which SQLite's NORMAL does not. A group of rows shares the wait.
        connection.execute(f"SET synchronous_commit = {'local' if access is Access.RECORD else 'on'}")
        connection.commit()

    return engine.execution_options(postgresql_readonly=access is Access.READ)


def _sqlite_engine(url: URL, access: Access) -> Engine:
    timeout_s = BUSY_TIMEOUT_MS / 1000
    engine = create_engine(url, connect_args={"timeout": timeout_s}, json_serializer=STRICT_JSON)

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, _record: Any) -> None:
        connection.isolation_level = None  # the driver shall begin nothing by itself
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute(f"PRAGMA synchronous={'NORMAL' if access is Access.RECORD else 'FULL'}")
        connection.execute("PRAGMA foreign_keys=ON")
        if access in (Access.READ, Access.LOOK):
            connection.execute("PRAGMA query_only=ON")

    if access is not Access.LOOK:

        @event.listens_for(engine, "begin")
        def begin_transaction(connection: Connection) -> None:
            connection.exec_driver_sql(SQLITE_BEGIN[access])

    return engine
