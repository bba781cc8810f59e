"""Import a site from another installation: looked at in a database of its own, then taken in as a whole."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from app.services.site_transfer_checks import check_site
from app.services.site_transfer_photos import ArrivingPhotos
from app.services.storage_budget import StorageBudget
from app.storage.archive_format import BadArchive, Manifest, Progress
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_schema import known_revisions
from app.storage.archive_site_copy import Ids, copy_site
from app.storage.archive_site_photos import settle_detections
from app.storage.archive_site_scratch import scratch_database
from app.storage.database import Database
from app.storage.photo_store import PhotoStore
from app.vision.photo import PhotoLimits

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
            photos = ArrivingPhotos(reader, target.database, target.photos, target.limits.photo)
            if_it_fails.callback(photos.remove)
            left_out = photos.keep(scratch, report)
            site_id = _take_rows(scratch, target, report)
        if_it_fails.pop_all()
        photos.keep_what_was_removed()
    return ImportedSite(site_id, reader.manifest.rows, len(reader.photos), left_out)


def _take_rows(scratch: Database, target: SiteTarget, report: Progress) -> str:
    with scratch.recording() as session:
        settle_detections(session)
    with scratch.reading() as looking:
        check_site(looking)
        with target.database.writing() as session:
            return copy_site(looking.connection(), session, Ids(new=target.as_new), report)


def _refuse_foreign(manifest: Manifest) -> None:
    if manifest.heading.kind != "site":
        raise BadArchive("the file holds a whole installation, not one site: `scattermark restore` takes it")
    if manifest.heading.revision not in known_revisions():
        raise BadArchive(
            f"the site was exported by Scattermark {manifest.heading.app_version!r:.40} with tables that this release "
            "does not know: import it with that release or a later one"
        )
