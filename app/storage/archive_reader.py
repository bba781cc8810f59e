"""An archive on its way in, trusted in nothing: its directory is checked first, then every digest, then it is read."""

from __future__ import annotations

import hashlib
import io
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from struct import error as StructError  # noqa: N812 - a class
from types import TracebackType
from typing import IO, Self
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

from app.storage.archive_format import (
    MANIFEST_NAME,
    MAX_MANIFEST_BYTES,
    SHA256,
    BadArchive,
    Manifest,
    Progress,
    TableMember,
    manifest_of_bytes,
    name_of_photo,
    name_of_table,
)

CHUNK_BYTES = 2**20
MAX_ROW_BYTES = 256 * 2**20  # a report of ten thousand photographs has some MB
ENCRYPTED_FLAG = 0x1  # APPNOTE 4.4.4
DAMAGED = "the archive is damaged ({}); take another copy of it"


class ArchiveReader:
    """One archive, open until the block ends. Nothing is ever unpacked under a name that it gives.

    Parameters
    ----------
    file : binary file
        Seekable; closed by whoever opened it.
    max_bytes : int or None
        The most that it may unpack to; None for an archive that the operator vouches for.

    Raises
    ------
    BadArchive
        When it is none, holds other things than its manifest says, or unpacks to more.
    """

    def __init__(self, file: IO[bytes], max_bytes: int | None = None) -> None:
        with _damage_told():
            self._zip = ZipFile(file)
            entries = {entry.filename: entry for entry in self._zip.infolist()}
            _refuse_tricks(self._zip.infolist(), entries, file.seek(0, os.SEEK_END))
            self.manifest = manifest_of_bytes(self._manifest_bytes(entries))
        _compare(entries, self.manifest)
        if max_bytes is not None and self.manifest.size_bytes > max_bytes:
            raise BadArchive(
                f"the archive unpacks to {self.manifest.size_bytes} bytes, and {max_bytes} are the limit here",
                max_bytes=max_bytes,
            )
        self.photos = tuple(name.rsplit("/", 1)[1] for name in entries if name.startswith("photographs/"))

    def verify(self, report: Progress) -> None:
        """Read everything once and compare it with its digest.

        Raises
        ------
        BadArchive
            At the first member that is not what it was.
        """
        total = len(self.manifest.tables) + len(self.photos)
        for done, table in enumerate(self.manifest.tables):
            report("check", done, total)
            self._verify_table(table)
        for done, sha256 in enumerate(self.photos, start=len(self.manifest.tables)):
            report("check", done, total)
            self.photo(sha256)
        report("check", total, total)

    def lines(self, name: str) -> Iterator[bytes]:
        """The rows of a table, one line each."""
        with _damage_told(), self._zip.open(name_of_table(name)) as member:
            buffered = io.BufferedReader(member, CHUNK_BYTES)  # type: ignore[type-var]
            while line := buffered.readline(MAX_ROW_BYTES):
                if not line.endswith(b"\n"):
                    raise BadArchive(DAMAGED.format(f"a row of {name} does not end"))
                yield line

    def photo(self, sha256: str) -> bytes:
        """A photograph of the archive.

        Raises
        ------
        BadArchive
            When its bytes have another digest.
        """
        with _damage_told():
            data = self._zip.read(name_of_photo(sha256))
        if hashlib.sha256(data).hexdigest() != sha256:
            raise BadArchive(DAMAGED.format(f"photograph {sha256} has other bytes than when it was archived"))
        return data

    def _verify_table(self, table: TableMember) -> None:
        digest, rows = hashlib.sha256(), 0
        with _damage_told(), self._zip.open(name_of_table(table.name)) as member:
            while chunk := member.read(CHUNK_BYTES):
                digest.update(chunk)
                rows += chunk.count(b"\n")
        if digest.hexdigest() != table.sha256 or rows != table.rows:
            raise BadArchive(DAMAGED.format(f"table {table.name} is not what it was when it was archived"))

    def _manifest_bytes(self, entries: dict[str, ZipInfo]) -> bytes:
        entry = entries.get(MANIFEST_NAME)
        if entry is None or entry.file_size > MAX_MANIFEST_BYTES:
            raise BadArchive("the file is no archive of Scattermark: it has no manifest")
        return self._zip.read(entry)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._zip.close()


def _refuse_tricks(listed: list[ZipInfo], entries: dict[str, ZipInfo], file_bytes: int) -> None:
    """Names that come twice, members that share their bytes (a bomb's trick), secrets, other compressions."""
    if len(listed) != len(entries):
        raise BadArchive("the archive names a member twice; it was not written by Scattermark")
    if sum(entry.compress_size for entry in listed) > file_bytes:
        raise BadArchive("the archive's members overlap; it was not written by Scattermark")
    for entry in listed:
        wanted = ZIP_STORED if entry.filename.startswith("photographs/") else ZIP_DEFLATED
        if entry.flag_bits & ENCRYPTED_FLAG or entry.compress_type != wanted:
            raise BadArchive(f"the archive's member {entry.filename!r:.100} is packed in a way that is not read here")


def _compare(entries: dict[str, ZipInfo], manifest: Manifest) -> None:
    """What the zip file lists must be what the manifest says: no more, no less, no path to anywhere."""
    tables = {name_of_table(table.name): table for table in manifest.tables}
    photos = [entry for name, entry in entries.items() if name not in tables and name != MANIFEST_NAME]
    for entry in photos:
        folder, _, digest = entry.filename.partition("/")
        if folder != "photographs" or not SHA256.fullmatch(digest):
            raise BadArchive(f"the archive holds {entry.filename!r:.100}, which has no place in one")
    for name, table in tables.items():
        if name not in entries or entries[name].file_size != table.size_bytes:
            raise BadArchive(DAMAGED.format(f"table {table.name} is missing or has another length"))
    told = manifest.photographs
    if len(photos) != told.count or sum(entry.file_size for entry in photos) != told.size_bytes:
        raise BadArchive(DAMAGED.format(f"it should hold {told.count} photographs and holds {len(photos)}"))


@contextmanager
def _damage_told() -> Iterator[None]:
    """What the zip file's reader finds wrong, as our error; it names faults by many classes."""
    try:
        yield
    except BadArchive:
        raise
    except (BadZipFile, zlib.error, EOFError, StructError, RuntimeError, OverflowError, ValueError) as error:
        raise BadArchive(DAMAGED.format(str(error)[:200] or type(error).__name__)) from error
