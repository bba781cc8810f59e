"""The tables of any revision, found by making them: what a database of that revision has, and nothing else."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Column,
    Connection,
    Double,
    ForeignKey,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    Text,
)
from sqlalchemy.types import Float, TypeEngine

from app.storage.database import Database
from app.storage.migrate import WrongTables, migrations_folder, upgrade

VERSION_TABLE = "alembic_version"
# Rows that mean nothing elsewhere: who is logged in, which process breathes. Their tables come back empty.
TRANSIENT = frozenset({"browser_sessions", "workers"})


def tables_at(revision: str) -> MetaData:
    """The tables that a database of a revision has, with types that both kinds of database understand.

    The models describe the newest tables only, and a database may hold tables that are not ours. So the migrations
    themselves are asked: they run once, on a file that nobody keeps.
    """
    return _made(revision).tables


def empty_file(revision: str) -> bytes:
    """The file of an SQLite database of a revision, without rows."""
    return _made(revision).file


@dataclass(frozen=True)
class _Made:
    file: bytes
    tables: MetaData


@cache
def _made(revision: str) -> _Made:
    reflected = MetaData()
    with tempfile.TemporaryDirectory(prefix="scattermark-") as folder:
        path = Path(folder) / "schema.db"
        database = Database(f"sqlite:///{path}")
        try:
            upgrade(database, revision)
            with database.reading() as session:
                reflected.reflect(session.connection(), resolve_fks=False)
        finally:
            database.close()
        file = path.read_bytes()
    tables = MetaData()
    for table in reflected.tables.values():
        if table.name != VERSION_TABLE:
            Table(table.name, tables, *(_plain_column(column) for column in table.columns))
    return _Made(file, tables)


def kept_tables(tables: MetaData) -> tuple[Table, ...]:
    """Those whose rows an archive keeps, each after the tables that it refers to."""
    return tuple(table for table in tables.sorted_tables if table.name not in TRANSIENT)


def revision_of(connection: Connection) -> str | None:
    """Revision of a database; None when it has no tables of ours."""
    return MigrationContext.configure(connection).get_current_revision()


def known_revisions() -> tuple[str, ...]:
    """All revisions of this release, the newest first."""
    return tuple(script.revision for script in ScriptDirectory(str(migrations_folder())).walk_revisions())


def _plain_column(column: Column[object]) -> Column[object]:
    # The constraint's own answer to a deletion plays no part in copying; the order of the tables does.
    references = [ForeignKey(key.target_fullname) for key in column.foreign_keys]
    return Column(column.name, _plain_type(column), *references, primary_key=column.primary_key)


def _plain_type(column: Column[object]) -> TypeEngine[object]:
    """One type for each form that an archive knows.

    Raises
    ------
    NotImplementedError
        For a column of a type that no archive has a form for yet: the programmer's business.
    """
    kind: TypeEngine[object] = column.type
    # Ancestors after their descendants.
    forms: tuple[tuple[type, TypeEngine[Any]], ...] = (
        (JSON, JSON(none_as_null=True)),
        (LargeBinary, LargeBinary()),
        (Boolean, Boolean()),
        (BigInteger, BigInteger()),
        (Integer, Integer()),
        (Float, Double()),
        (Text, Text()),
        (String, String(getattr(kind, "length", None))),
    )
    for ancestor, form in forms:
        if isinstance(kind, ancestor):
            return form
    raise NotImplementedError(f"archives have no form for {column}, a column of type {kind!r}")


def current_revision(connection: Connection) -> str:
    """Revision of a database that this release knows.

    Raises
    ------
    WrongTables
        When the database has no tables, or those of another release.
    """
    revision = revision_of(connection)
    if revision is None:
        raise WrongTables("the database has no tables yet: check SCATTERMARK_DATABASE_URL and --data-dir")
    if revision not in known_revisions():
        raise WrongTables(
            f"the database's tables are of revision {revision}, which this release does not know: use the release that "
            "the service runs with"
        )
    return revision
