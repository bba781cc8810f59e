"""Rows of whole databases on their way into an archive and out of it, a batch at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from sqlalchemy import Connection, MetaData, Select, Table, func, insert, select, text, update
from sqlalchemy.exc import DataError, IntegrityError

from app.storage.archive_format import BadArchive, Progress
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_rows import RowForm
from app.storage.archive_schema import kept_tables
from app.storage.archive_writer import ArchiveWriter
from app.storage.jobs import OPEN_STATES
from app.storage.models import JobRow

ROWS_AT_ONCE = 500  # a pose row with all that it saw has some kB
PHOTO_COLUMNS = (("photographs", "sha256"), ("kept_snapshots", "sha256"))  # where rows name photographs


class Counter:
    """Tells how many rows of all are done."""

    def __init__(self, report: Progress, total: int) -> None:
        self._report, self._total, self._done = report, total, 0

    def add(self, count: int) -> None:
        """Some more are done."""
        self._done += count
        self._report("rows", self._done, self._total)


def write_rows(writer: ArchiveWriter, connection: Connection, tables: MetaData, report: Progress) -> None:
    """Add all rows that an archive keeps, as one transaction sees them."""
    kept = kept_tables(tables)
    counter = Counter(report, sum(_count(connection, table) for table in kept))
    for table in kept:
        query = select(table).order_by(*table.primary_key.columns)
        writer.add_table(table.name, RowForm(table).columns, lines_of(connection, query, table, counter))


def lines_of(connection: Connection, query: Select[Any], table: Table, counter: Counter) -> Iterator[bytes]:
    """The rows of a query over all columns of a table, as an archive's lines."""
    form = RowForm(table)
    result = connection.execution_options(yield_per=ROWS_AT_ONCE).execute(query)
    for batch in result.partitions():
        yield from map(form.line, batch)
        counter.add(len(batch))


def read_rows(reader: ArchiveReader, connection: Connection, tables: MetaData, report: Progress) -> None:
    """Insert all rows of an archive into tables that are there and empty.

    Raises
    ------
    BadArchive
        When they do not fit the tables or each other.
    """
    kept = kept_tables(tables)
    check_members(reader, kept)
    counter = Counter(report, reader.manifest.rows)
    for table in kept:
        form = RowForm(table)
        for lines in batched_lines(reader, table.name):
            insert_rows(connection, table, [form.values(line) for line in lines])
            counter.add(len(lines))
    check_references(connection)


def check_members(reader: ArchiveReader, tables: Iterable[Table]) -> None:
    """See that an archive has these tables with these columns.

    Raises
    ------
    BadArchive
    """
    wanted = {table.name: RowForm(table).columns for table in tables}
    found = {table.name: table.columns for table in reader.manifest.tables}
    if wanted != found:
        raise BadArchive(
            f"the archive's tables are not those of its revision {reader.manifest.heading.revision}: it was not "
            "written by Scattermark, or by a release that was never published"
        )


def batched_lines(reader: ArchiveReader, name: str) -> Iterator[tuple[bytes, ...]]:
    """The lines of a table, some at a time."""
    lines = reader.lines(name)
    while batch := tuple(islice(lines, ROWS_AT_ONCE)):
        yield batch


def insert_rows(connection: Connection, table: Table, rows: list[dict[str, Any]]) -> None:
    """Insert some rows.

    Raises
    ------
    BadArchive
        When the database refuses them.
    """
    try:
        connection.execute(insert(table), rows)
    except (IntegrityError, DataError) as error:
        raise BadArchive(f"the archive holds rows that table {table.name} cannot take ({error.orig})") from error


def check_references(connection: Connection) -> None:
    """See that each row that another one refers to is there: SQLite does not while tables are being changed.

    Raises
    ------
    BadArchive
    """
    if connection.dialect.name != "sqlite":
        return
    lost = connection.execute(text("PRAGMA foreign_key_check")).first()
    if lost is not None:
        raise BadArchive(f"the archive holds a row of {lost[0]} that belongs to a row of {lost[2]} which is not there")


def reopen_jobs(connection: Connection) -> None:
    """Put jobs that were under way when the backup was made back in the queue: whoever ran them is not here.

    They run as a new attempt, so that nothing is heard that an engine beside this database still says of the old one.
    """
    first = {
        "state": "queued",
        "stage": "queued",
        "done": 0,
        "total": 0,
        "owner": None,
        "strikes": 0,
        "started_s": None,
    }
    again = update(JobRow).where(JobRow.state.in_(OPEN_STATES)).values(attempt=JobRow.attempt + 1, **first)
    connection.execute(again)


def photos_of(connection: Connection, tables: MetaData) -> tuple[str, ...]:
    """Digests of all photographs that rows refer to, each once."""
    digests: set[str] = set()
    for name, column in PHOTO_COLUMNS:
        if name in tables.tables and column in tables.tables[name].columns:
            found = tables.tables[name].columns[column]
            digests.update(connection.scalars(select(found).where(found.is_not(None)).distinct()))
    return tuple(sorted(digests))


def _count(connection: Connection, table: Table) -> int:
    return connection.scalar(select(func.count()).select_from(table)) or 0
