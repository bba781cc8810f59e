"""An archive on its way out: row by row, photograph by photograph; nothing is held but the zip file's directory."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from types import TracebackType
from typing import IO, Self
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from app.storage.archive_format import (
    MANIFEST_NAME,
    Heading,
    Manifest,
    Photographs,
    TableMember,
    bytes_of_manifest,
    name_of_photo,
    name_of_table,
)


class ArchiveWriter:
    """Writes one archive; it is one when ``finish`` has returned.

    Parameters
    ----------
    out : binary file
        Need not be seekable.
    """

    def __init__(self, out: IO[bytes]) -> None:
        self._zip = ZipFile(out, "w", allowZip64=True)
        self._tables: list[TableMember] = []
        self._photo_count = 0
        self._photo_bytes = 0

    def add_table(self, name: str, columns: tuple[str, ...], lines: Iterable[bytes]) -> None:
        """Add the rows of a table, one line each."""
        digest = hashlib.sha256()
        rows = size_bytes = 0
        entry = _entry(name_of_table(name), ZIP_DEFLATED)
        with self._zip.open(entry, "w", force_zip64=True) as member:  # its size is not known yet
            for line in lines:
                member.write(line)
                digest.update(line)
                rows += 1
                size_bytes += len(line)
        self._tables.append(TableMember(name, columns, rows, size_bytes, digest.hexdigest()))

    def add_photo(self, sha256: str, data: bytes) -> None:
        """Add a photograph, which is compressed already."""
        self._zip.writestr(_entry(name_of_photo(sha256), ZIP_STORED), data)
        self._photo_count += 1
        self._photo_bytes += len(data)

    def finish(self, heading: Heading, *, with_photographs: bool, missing: tuple[str, ...] = ()) -> Manifest:
        """Write the manifest and the zip file's directory; the manifest."""
        photographs = Photographs(with_photographs, self._photo_count, self._photo_bytes, missing)
        manifest = Manifest(heading, tuple(self._tables), photographs)
        self._zip.writestr(_entry(MANIFEST_NAME, ZIP_DEFLATED), bytes_of_manifest(manifest))
        self._zip.close()
        return manifest

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # After an error the directory must not be written: half an archive would look like a whole one.
        if error is not None:
            self._zip.fp = None


def _entry(name: str, compression: int) -> ZipInfo:
    entry = ZipInfo(name)  # of a fixed date: the same content gives the same bytes
    entry.compress_type = compression
    entry.external_attr = 0o600 << 16
    return entry
