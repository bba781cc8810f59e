"""Files of photographs are removed under a lock that whoever uses them takes too: nothing that is used is ever gone."""

from __future__ import annotations

from collections.abc import Iterable

from app.storage.database import Database
from app.storage.photo_references import lock_photos, referred_to
from app.storage.photo_store import PhotoStore

REMOVED_AT_A_TIME = 100  # files of one transaction: on SQLite all other writers wait for it


def remove_unused(database: Database, photos: PhotoStore, digests: Iterable[str]) -> int:
    """Remove those of the photographs that no row refers to; how many.

    Whoever is about to refer to one of them takes the same lock, then looks whether its file is there still.

    Raises
    ------
    StorageUnavailable
    """
    removed = 0
    wanted = sorted(set(digests))
    for start in range(0, len(wanted), REMOVED_AT_A_TIME):
        batch = wanted[start : start + REMOVED_AT_A_TIME]
        with database.writing() as session:
            lock_photos(session, batch)
            unused = set(batch) - referred_to(session, batch)
            for digest in sorted(unused):
                photos.delete(digest)
        removed += len(unused)
    return removed
