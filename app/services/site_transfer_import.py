"""Import a site from another installation: looked at in a database of its own, then taken in as a whole."""

from __future__ import annotations

import hashlib
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import IO

from app.errors import ScattermarkError
from app.services.site_transfer_checks import check_site
from app.services.storage_budget import StorageBudget
from app.storage.archive_format import BadArchive, Manifest, Progress
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_schema import known_revisions
from app.storage.archive_site_copy import Ids, copy_site
from app.storage.archive_site_photos import (
    SeenPhoto,
    describe_photo,
    leave_out_photo,
    named_photos,
    settle_detections,
)
from app.storage.archive_site_scratch import scratch_database
from app.storage.database import Database
from app.storage.photo_store import PhotoStore
from app.vision.photo import PhotoLimits, read_header
from app.vision.privacy.without_position import without_position

UNPACKED = 4  # bytes for each one that is sent: rows of numbers take a third to a fifth of their length when packed


@dataclass(frozen=True)
class ImportLimits:
    """What an archive may take.

    Attributes
    ----------
    photo : PhotoLimits
        Of each photograph.
    scratch : Path
        Folder of a disk that can hold the site's rows while they are looked at.
    max_unpacked_bytes : int or None
        Of everything in it; None for an archive that the operator vouches for.
    """

    photo: PhotoLimits
    scratch: Path
    max_unpacked_bytes: int | None = None


@dataclass(frozen=True)
class SiteTarget:
    """Where a site is imported to.

    Attributes
    ----------
    as_new : bool
        Give everything new ids, so that the site can be beside the one it was exported from.
    """

    database: Database
    photos: PhotoStore
    budget: StorageBudget
    limits: ImportLimits
    as_new: bool = False


@dataclass(frozen=True)
class ImportedSite:
    """A site that was taken in.

    Attributes
    ----------
    left_out : tuple of str
        Names of photographs whose bytes the archive does not hold.
    """

    site_id: str
    rows: int
    photographs: int
    left_out: tuple[str, ...]


def import_site(file: IO[bytes], target: SiteTarget, report: Progress) -> ImportedSite:
    """Take a site in, all of it or nothing. Nothing that the archive says of itself is believed.

    Raises
    ------
    BadArchive
        When it is damaged, of another kind or of a later release, or holds what no installation could have written.
    Conflict
        When the site is here already and ``as_new`` is not wanted.
    OutOfSpace
        When its photographs exceed the quota or the disk.
    """
    with ArchiveReader(file, target.limits.max_unpacked_bytes) as reader, ExitStack() as if_it_fails:
        _refuse_foreign(reader.manifest)
        target.budget.admit(reader.manifest.photographs.size_bytes)
        reader.verify(report)
        with scratch_database(reader, target.limits.scratch, report) as scratch:
            left_out = _take_photos(reader, scratch, target, if_it_fails, report)
            with scratch.recording() as session:
                settle_detections(session)
            with scratch.reading() as looking:
                check_site(looking)
                with target.database.writing() as session:
                    site_id = copy_site(looking.connection(), session, Ids(new=target.as_new), report)
        if_it_fails.pop_all()
    return ImportedSite(site_id, reader.manifest.rows, len(reader.photos), left_out)


def _refuse_foreign(manifest: Manifest) -> None:
    if manifest.heading.kind != "site":
        raise BadArchive("the file holds a whole installation, not one site: `scattermark restore` takes it")
    if manifest.heading.revision not in known_revisions():
        raise BadArchive(
            f"the site was exported by Scattermark {manifest.heading.app_version!r:.40} with tables that this release "
            "does not know: import it with that release or a later one"
        )


def _take_photos(
    reader: ArchiveReader, scratch: Database, target: SiteTarget, if_it_fails: ExitStack, report: Progress
) -> tuple[str, ...]:
    """Keep the photographs, each as it would be kept had it been uploaded; the names of those that did not come."""
    with scratch.recording() as session:
        names: dict[str, list[str]] = {}
        for name, sha256 in named_photos(session):
            names.setdefault(sha256, []).append(name)
        if not names.keys() >= set(reader.photos):
            raise BadArchive("the archive holds photographs that belong to no survey")
        for done, sha256 in enumerate(reader.photos):
            report("photographs", done, len(reader.photos))
            data = reader.photo(sha256)
            describe_photo(session, sha256, _keep(names[sha256][0], data, target, if_it_fails))
        report("photographs", len(reader.photos), len(reader.photos))
        absent = names.keys() - set(reader.photos)
        for sha256 in absent:
            leave_out_photo(session, sha256)
        return tuple(sorted(name for sha256 in absent for name in names[sha256]))


def _keep(name: str, data: bytes, target: SiteTarget, if_it_fails: ExitStack) -> SeenPhoto:
    try:
        header = read_header(data, target.limits.photo)
    except ScattermarkError as error:
        raise BadArchive(f"photograph {name!r:.100} of the archive cannot be taken: {error.detail}") from error
    kept = without_position(data)
    sha256 = hashlib.sha256(kept).hexdigest()
    if not target.photos.holds(sha256):
        if_it_fails.callback(partial(target.photos.delete, sha256))
        target.photos.put(sha256, kept)
    return SeenPhoto(sha256, len(kept), header.identity, header.captured_at)
