"""Export a site: its rows as one moment saw them and its photographs, in one file that another installation imports."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, cast

from app.services.backup import whole_file
from app.services.backup_parts import heading_of, unaltered, write_photos
from app.storage.archive_format import Manifest, Progress
from app.storage.archive_schema import current_revision, tables_at
from app.storage.archive_site import photos_of_site, write_site
from app.storage.archive_writer import ArchiveWriter
from app.storage.database import Database
from app.storage.photo_store import PhotoStore
from app.storage.sites import SiteRepository

SPOOLED_BYTES = 2**24  # of rows that are held in memory, before they go to the disk
CHUNK_BYTES = 2**18


@dataclass(frozen=True)
class SiteSource:
    """A site and where it is kept."""

    database: Database
    photos: PhotoStore
    site_id: str


def export_site(source: SiteSource, path: Path, report: Progress) -> Manifest:
    """Write a site's archive, whole or not at all.

    Raises
    ------
    NotFound
    """
    with whole_file(path) as out, ArchiveWriter(out) as writer:
        revision, digests = _write_rows(writer, source, report)
        missing = write_photos(writer, source.photos, digests, report)
        return writer.finish(heading_of("site", revision), with_photographs=True, missing=missing)


def site_chunks(source: SiteSource) -> Iterator[bytes]:
    """A site's archive as it is made: nothing is held but the rows, and these on the disk when they are many.

    The rows are all read before the first bytes leave, so that a slow reader holds no transaction open. What breaks off
    has no end and is no archive.

    Raises
    ------
    NotFound
        Before the first bytes.
    """
    with tempfile.SpooledTemporaryFile(SPOOLED_BYTES) as spool:
        sink = cast("IO[bytes]", _Sink(spool))
        with ArchiveWriter(sink) as writer:
            revision, digests = _write_rows(writer, source, _quiet)
            yield from _drained(spool)
            missing = []
            for sha256 in digests:
                data = unaltered(source.photos, sha256)
                if data is None:
                    missing.append(sha256)
                    continue
                writer.add_photo(sha256, data)
                yield from _drained(spool)
            writer.finish(heading_of("site", revision), with_photographs=True, missing=tuple(missing))
            yield from _drained(spool)


class _Sink:
    """A file that can be written to and not sought in, so that what was written may be taken away."""

    def __init__(self, spool: IO[bytes]) -> None:
        self._spool = spool

    def write(self, data: bytes) -> int:
        return self._spool.write(data)

    def flush(self) -> None:
        self._spool.flush()


def _drained(spool: IO[bytes]) -> Iterator[bytes]:
    spool.seek(0)
    while chunk := spool.read(CHUNK_BYTES):
        yield chunk
    spool.seek(0)
    spool.truncate()


def _write_rows(writer: ArchiveWriter, source: SiteSource, report: Progress) -> tuple[str, tuple[str, ...]]:
    """Revision of the rows and digests of the photographs."""
    with source.database.reading() as session:
        SiteRepository(session).get(source.site_id)
        connection = session.connection()
        revision = current_revision(connection)
        tables = tables_at(revision)
        write_site(writer, connection, tables, source.site_id, report)
        return revision, photos_of_site(connection, tables, source.site_id)


def _quiet(_stage: str, _done: int, _total: int) -> None:
    """A stream tells nobody how far it is."""
