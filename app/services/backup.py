"""Back up an installation: all rows as one moment saw them, and the photographs that they name, in one file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from app.services.backup_parts import heading_of, write_photos
from app.storage.archive_format import Manifest, Progress
from app.storage.archive_schema import current_revision, tables_at
from app.storage.archive_writer import ArchiveWriter
from app.storage.backup_rows import photos_of, write_rows
from app.storage.database import Database
from app.storage.durable_files import sync_folder
from app.storage.photo_store import PhotoStore


@dataclass(frozen=True)
class Backup:
    """A backup that was written.

    Attributes
    ----------
    lost : tuple of str
        Digests of photographs that the database still names and the store does not hold unaltered.
    """

    manifest: Manifest
    lost: tuple[str, ...] = ()


def back_up(database: Database, photos: PhotoStore | None, path: Path, report: Progress) -> Backup:
    """Write a backup, whole or not at all; the service may go on meanwhile.

    Parameters
    ----------
    photos : PhotoStore or None
        None leaves the photographs out.
    path : Path
        What is there is replaced once the backup is whole.

    Raises
    ------
    WrongTables
        When the database has no tables, or those of a later release.
    StorageUnavailable
        When it gives no answer.
    """
    with whole_file(path) as out, ArchiveWriter(out) as writer:
        with database.reading() as session:
            connection = session.connection()
            revision = current_revision(connection)
            tables = tables_at(revision)
            write_rows(writer, connection, tables, report)
            digests = () if photos is None else photos_of(connection, tables)
        # Photographs never change, so they may be copied when the moment of the rows has passed.
        missing = () if photos is None else write_photos(writer, photos, digests, report)
        manifest = writer.finish(heading_of("backup", revision), with_photographs=photos is not None, missing=missing)
    return Backup(manifest, _still_named(database, missing))


@contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """A file that stands under its name when the block has ended well, and not at all otherwise."""
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
        partial = Path(file.name)
        try:
            yield file
            file.flush()
            os.fsync(file.fileno())
        except BaseException:
            partial.unlink()
            raise
    partial.replace(path)
    sync_folder(path.parent)


def _still_named(database: Database, digests: tuple[str, ...]) -> tuple[str, ...]:
    """Those of the photographs that nobody has removed in the meantime."""
    if not digests:
        return ()
    with database.reading() as session:
        connection = session.connection()
        named = set(photos_of(connection, tables_at(current_revision(connection))))
    return tuple(digest for digest in digests if digest in named)
