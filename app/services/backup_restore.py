"""Restore a backup: everything is checked before anything is touched, and appears in one transaction or not at all."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from app.errors import Conflict
from app.storage.archive_format import BadArchive, Manifest, Progress
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_schema import known_revisions, tables_at
from app.storage.backup_rows import read_rows, reopen_jobs
from app.storage.backup_target import drop_tables, holds_rows, refuse_when_in_use
from app.storage.database import Database
from app.storage.migrate import upgrade_on
from app.storage.photo_store import PhotoStore


@dataclass(frozen=True)
class Target:
    """Where a backup is restored to; ``replace`` removes what is there."""

    database: Database
    photos: PhotoStore
    replace: bool = False


def restore(path: Path, target: Target, report: Progress) -> Manifest:
    """Restore a backup into either kind of database, and bring it to the tables of this release.

    Raises
    ------
    BadArchive
        When the file is no whole backup, or of a later release.
    Conflict
        When the database is in use, or holds something and shall not be replaced.
    StorageUnavailable
        When it gives no answer, or the photographs cannot be kept.
    """
    with path.open("rb") as file, ArchiveReader(file) as reader:
        _refuse_foreign(reader.manifest)
        refuse_when_in_use(target.database)
        _refuse_rows(target)
        reader.verify(report)
        with ExitStack() as if_it_fails:
            put_photos(reader, target.photos, if_it_fails, report)
            _replace_rows(reader, target, report)
            if_it_fails.pop_all()
    return reader.manifest


def put_photos(reader: ArchiveReader, photos: PhotoStore, if_it_fails: ExitStack, report: Progress) -> None:
    """Keep an archive's photographs; those that were not there before are removed again when the rest fails."""
    for done, sha256 in enumerate(reader.photos):
        report("photographs", done, len(reader.photos))
        if not photos.holds(sha256):
            if_it_fails.callback(partial(photos.delete, sha256))
            photos.put(sha256, reader.photo(sha256))
    report("photographs", len(reader.photos), len(reader.photos))


def _replace_rows(reader: ArchiveReader, target: Target, report: Progress) -> None:
    """All in one transaction: whoever looks sees the old rows or the new ones, also after a power cut."""
    revision = reader.manifest.heading.revision
    with target.database.migrating() as connection:
        drop_tables(connection)
        upgrade_on(connection, revision)
        read_rows(reader, connection, tables_at(revision), report)
        upgrade_on(connection)
        reopen_jobs(connection)


def _refuse_foreign(manifest: Manifest) -> None:
    if manifest.heading.kind != "backup":
        raise BadArchive("the file holds one site, not a whole installation: `scattermark import` takes it")
    if manifest.heading.revision not in known_revisions():
        raise BadArchive(
            f"the backup has tables of revision {manifest.heading.revision!r:.40}, made by Scattermark "
            f"{manifest.heading.app_version!r:.40}, and this release does not know them: restore with that release "
            "or a later one"
        )


def _refuse_rows(target: Target) -> None:
    with target.database.reading() as session:
        if not target.replace and holds_rows(session.connection()):
            raise Conflict(
                "the database is not empty: restore into another one (--data-dir, SCATTERMARK_DATABASE_URL), or say "
                "--force, which removes all that it holds"
            )
