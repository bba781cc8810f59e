"""The database that a backup is restored into: whether it is in use, whether it is empty, and making it so."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

from sqlalchemy import Connection, make_url, select, text

from app.errors import Conflict
from app.storage.archive_schema import VERSION_TABLE, current_revision, revision_of, tables_at
from app.storage.database import Database

IN_USE_TIMEOUT_S = 1.0  # a connection that is just being closed gets this long
# Of the same user: a monitor that watches the server under a name of its own is no service of ours.
OTHERS = """
SELECT count(*) FROM pg_stat_activity
WHERE datname = current_database() AND usename = current_user AND pid <> pg_backend_pid()
AND backend_type = 'client backend'
"""


def refuse_when_in_use(database: Database) -> None:
    """See that no service has the database open; to be asked before this process itself has connected.

    Raises
    ------
    Conflict
    StorageUnavailable
        When the database gives no answer.
    """
    url = make_url(database.url)
    if url.get_backend_name() == "sqlite":
        in_use = url.database is not None and _file_in_use(Path(url.database))
    else:
        with database.reading() as session:
            in_use = bool(session.scalar(text(OTHERS)))
    if in_use:
        raise Conflict(
            "the database is in use: stop the service and its workers, and whatever else has it open, then restore"
        )


def holds_rows(connection: Connection) -> bool:
    """Whether any of our tables has a row.

    Raises
    ------
    WrongTables
        When the tables are of a release that is not known here.
    """
    if revision_of(connection) is None:
        return False
    tables = tables_at(current_revision(connection)).sorted_tables
    return any(connection.execute(select(table).limit(1)).first() is not None for table in tables)


def drop_tables(connection: Connection) -> None:
    """Remove our tables with their rows, and nothing else.

    Raises
    ------
    WrongTables
        When they are of a release that is not known here.
    """
    if revision_of(connection) is None:
        return
    tables_at(current_revision(connection)).drop_all(connection)
    connection.execute(text(f"DROP TABLE {VERSION_TABLE}"))


def _file_in_use(path: Path) -> bool:
    """Only who has the file alone can take it out of WAL mode; the next to connect puts it back."""
    if not path.exists():
        return False
    with closing(sqlite3.connect(path, timeout=IN_USE_TIMEOUT_S)) as connection:
        try:
            connection.execute("PRAGMA journal_mode=DELETE").fetchone()
        except sqlite3.OperationalError as error:
            if error.sqlite_errorname in ("SQLITE_BUSY", "SQLITE_LOCKED"):
                return True
            raise Conflict(f"the database {path} cannot be used ({error}); move it away and restore again") from error
    return False
