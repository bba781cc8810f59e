"""Photographs of a site that is being imported: kept as if each had been uploaded, beside uploads and purges."""

from __future__ import annotations

import hashlib
from contextvars import Context

from app.errors import ScattermarkError
from app.services.photo_removal import REMOVED_AT_A_TIME, remove_unused
from app.storage.archive_format import BadArchive, Progress
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_site_photos import SeenPhoto, describe_photo, leave_out_photo, named_photos
from app.storage.database import Database
from app.storage.photo_references import lock_photos
from app.storage.photo_store import PhotoStore
from app.vision.photo import PhotoLimits, read_header
from app.vision.privacy.without_position import without_position


class ArrivingPhotos:
    """The photographs of an archive on their way into a store.

    Parameters
    ----------
    reader : ArchiveReader
    database : Database
        Whose rows say which photographs of the store are used.
    photos : PhotoStore
    limits : PhotoLimits
    """

    def __init__(self, reader: ArchiveReader, database: Database, photos: PhotoStore, limits: PhotoLimits) -> None:
        self._reader = reader
        self._database = database
        self._photos = photos
        self._limits = limits
        self._kept: dict[str, str] = {}  # digest in the archive by digest here

    def keep(self, scratch: Database, report: Progress) -> tuple[str, ...]:
        """Put all into the store, and say in a scratch database what they are; the names of those that did not come.

        Raises
        ------
        BadArchive
            For one that no survey would have taken, or that belongs to none.
        """
        with scratch.recording() as session:
            names: dict[str, list[str]] = {}
            for name, sha256 in named_photos(session):
                names.setdefault(sha256, []).append(name)
            if not names.keys() >= set(self._reader.photos):
                raise BadArchive("the archive holds photographs that belong to no survey")
            for done, sha256 in enumerate(self._reader.photos):
                report("photographs", done, len(self._reader.photos))
                describe_photo(session, sha256, self._keep_one(names[sha256][0], sha256))
            report("photographs", len(self._reader.photos), len(self._reader.photos))
            absent = names.keys() - set(self._reader.photos)
            for sha256 in absent:
                leave_out_photo(session, sha256)
        return tuple(sorted(name for sha256 in absent for name in names[sha256]))

    def remove(self) -> None:
        """Take away what was kept and nothing refers to: the import has failed.

        In a context of its own, as nothing has been changed that the audit should tell of.
        """
        Context().run(remove_unused, self._database, self._photos, self._kept)

    def keep_what_was_removed(self) -> None:
        """Once rows refer to the photographs: a purge that had begun before may have taken some away."""
        digests = sorted(self._kept)
        for start in range(0, len(digests), REMOVED_AT_A_TIME):
            batch = digests[start : start + REMOVED_AT_A_TIME]
            with self._database.recording() as session:
                lock_photos(session, batch)
                for sha256 in batch:
                    if not self._photos.holds(sha256):
                        self._photos.put(sha256, without_position(self._reader.photo(self._kept[sha256])))

    def _keep_one(self, name: str, archived_sha256: str) -> SeenPhoto:
        data = self._reader.photo(archived_sha256)
        try:
            header = read_header(data, self._limits)
        except ScattermarkError as error:
            raise BadArchive(f"photograph {name!r:.100} of the archive cannot be taken: {error.detail}") from error
        kept = without_position(data)
        sha256 = hashlib.sha256(kept).hexdigest()
        self._kept[sha256] = archived_sha256
        self._photos.put(sha256, kept)
        return SeenPhoto(sha256, len(kept), header.identity, header.captured_at)
