"""A site's archive in a database of its own, where it can be looked at before it comes near any other site."""

from __future__ import annotations

import math
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Float, LargeBinary, String, Table

from app.storage.archive_format import SHA256, BadArchive, Progress
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_rows import RowForm
from app.storage.archive_schema import empty_file, known_revisions, tables_at
from app.storage.archive_site import site_tables
from app.storage.backup_rows import Counter, batched_lines, check_members, check_references, insert_rows
from app.storage.blobs import STORED
from app.storage.database import Database
from app.storage.migrate import upgrade_on

# RFC 9562, version 7: what ``new_id`` makes.
OUR_ID = re.compile(r"[0-9a-f]{8}-[0-9a-f]{4}-7[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}")
OUR_IDS = frozenset({"id", "site_id", "survey_id", "map_id", "trajectory_id", "job_id"})
LATEST_S = 253_402_300_799.0  # the end of the year 9999, the last that ISO 8601 writes with four digits
NO_ARRAYS = frozenset({"record"})  # blobs that are no plain array


@contextmanager
def scratch_database(reader: ArchiveReader, folder: Path, report: Progress) -> Iterator[Database]:
    """The rows of a site's archive, brought to the newest tables, in a file that is gone when the block ends.

    Parameters
    ----------
    folder : Path
        Of the disk that has to hold it.

    Raises
    ------
    BadArchive
        When the rows do not fit their tables or each other.
    """
    with tempfile.TemporaryDirectory(dir=folder, prefix="import-") as scratch:
        path = Path(scratch) / "site.db"
        path.write_bytes(empty_file(reader.manifest.heading.revision))
        database = Database(f"sqlite:///{path}")
        try:
            _fill(database, reader, report)
            yield database
        finally:
            database.close()


def _fill(database: Database, reader: ArchiveReader, report: Progress) -> None:
    revision = reader.manifest.heading.revision
    tables = site_tables(tables_at(revision))
    check_members(reader, tables)
    counter = Counter(report, reader.manifest.rows)
    with database.migrating() as connection:
        for table in tables:
            form = RowForm(table)
            for lines in batched_lines(reader, table.name):
                insert_rows(connection, table, [_fitting(table, form.values(line)) for line in lines])
                counter.add(len(lines))
        check_references(connection)
        if revision != known_revisions()[0]:
            upgrade_on(connection)


def _fitting(table: Table, values: dict[str, Any]) -> dict[str, Any]:
    """The values of a row, each of which its column can hold on any database."""
    for name, value in values.items():
        if value is not None and not _fits(table, name, value):
            raise BadArchive(f"the archive holds a row of {table.name} whose {name} cannot be right")
    return values


def _fits(table: Table, name: str, value: Any) -> bool:
    kind = table.columns[name].type
    if isinstance(kind, Float):
        return math.isfinite(value) and (not name.endswith("_s") or 0.0 <= value <= LATEST_S)
    if isinstance(kind, LargeBinary):
        return name in NO_ARRAYS or _finite(value)
    if name in OUR_IDS:
        return OUR_ID.fullmatch(value) is not None
    if name.endswith("sha256"):
        return SHA256.fullmatch(value) is not None
    return not isinstance(kind, String) or kind.length is None or len(value) <= kind.length


def _finite(blob: bytes) -> bool:
    return len(blob) % STORED.itemsize == 0 and bool(np.isfinite(np.frombuffer(blob, dtype=STORED)).all())
