"""What nobody needs any more is removed: pictures past their time, files and detections that nothing refers to.

Any number of workers may do it at once, beside uploads: a file goes only under the lock of whoever would use it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from app.services.photo_removal import remove_unused
from app.storage.database import Database
from app.storage.kept_snapshots import KeptSnapshotRepository
from app.storage.objects import StoredObject
from app.storage.photo_references import count_stray_detections, delete_stray_detections, referred_to
from app.storage.photo_store import PhotoStore

# A file is written before its row: younger ones are left alone. They would not be lost, only written twice.
ORPHAN_GRACE_S = 3600.0
LOOKED_AT_A_TIME = 500  # SQLite takes 999 parameters in its oldest builds


@dataclass(frozen=True)
class HousekeepingReport:
    """What was removed, or would be.

    Attributes
    ----------
    expired_snapshots : int
        Kept pictures past their site's time.
    orphan_photographs, orphan_bytes : int
        Files that no row refers to, beside those of expired snapshots.
    stray_detections : int
        Detections of photographs that no survey has.
    abandoned_files : int
        Left behind by processes that were killed while they wrote.
    """

    expired_snapshots: int
    orphan_photographs: int
    orphan_bytes: int
    stray_detections: int
    abandoned_files: int


def housekeep(database: Database, photos: PhotoStore, now_s: float) -> HousekeepingReport:
    """Remove what nobody needs any more.

    Parameters
    ----------
    database : Database
    photos : PhotoStore
    now_s : float
        UTC seconds.

    Raises
    ------
    StorageUnavailable
        When database or store give no answer; what was removed until then was not needed.
    """
    expired = _remove_expired(database, photos, now_s)
    orphans = list(_orphans(database, photos, now_s))
    remove_unused(database, photos, (orphan.name for orphan in orphans))
    with database.writing() as session:
        strays = delete_stray_detections(session, now_s - ORPHAN_GRACE_S)
    return HousekeepingReport(expired, len(orphans), _size(orphans), strays, photos.sweep(now_s))


def look_around(database: Database, photos: PhotoStore, now_s: float) -> HousekeepingReport:
    """What ``housekeep`` would remove now; nothing changes."""
    orphans = list(_orphans(database, photos, now_s))
    with database.reading() as session:
        expired = KeptSnapshotRepository(session).count_expired(now_s)
        strays = count_stray_detections(session, now_s - ORPHAN_GRACE_S)
    return HousekeepingReport(expired, len(orphans), _size(orphans), strays, photos.sweep(now_s, dry_run=True))


def _remove_expired(database: Database, photos: PhotoStore, now_s: float) -> int:
    removed = 0
    while True:
        with database.writing() as session:
            digests = KeptSnapshotRepository(session).remove_expired(now_s, LOOKED_AT_A_TIME)
        remove_unused(database, photos, digests)
        removed += len(digests)
        if len(digests) < LOOKED_AT_A_TIME:
            return removed


def _orphans(database: Database, photos: PhotoStore, now_s: float) -> Iterator[StoredObject]:
    """Files that no row refers to and that have been there for a while."""
    old = (item for item in photos.photos() if item.modified_s < now_s - ORPHAN_GRACE_S)
    while batch := list(islice(old, LOOKED_AT_A_TIME)):
        with database.reading() as session:
            used = referred_to(session, [item.name for item in batch])
        yield from (item for item in batch if item.name not in used)


def _size(items: Sequence[StoredObject]) -> int:
    return sum(item.size_bytes for item in items)
