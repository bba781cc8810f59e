"""Pictures of snapshots, for sites that want them kept."""

from __future__ import annotations

import asyncio
import hashlib
import logging
import sys
import time
from dataclasses import dataclass

from app.errors import ScattermarkError
from app.services.storage_budget import StorageBudget
from app.storage.database import Database
from app.storage.kept_snapshots import KeptSnapshot, KeptSnapshotRepository
from app.storage.photo_references import lock_photos
from app.storage.photo_store import PhotoStore
from app.storage.records import Keep
from app.storage.snapshots import Located, Snapshot
from app.vision.photo import PhotoLimits, read_header
from app.vision.privacy.without_position import without_position

ANY_SIZE = PhotoLimits(sys.maxsize, sys.maxsize)  # it was let in under the limits of its day

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Picture:
    """The bytes of a kept picture and their format: ``JPEG``, ``PNG``, ``WEBP`` or ``HEIC``."""

    data: bytes
    format: str


class SnapshotKeeper:
    """Keeps pictures beside their poses, without the position that a phone wrote into them."""

    def __init__(self, database: Database, photos: PhotoStore, budget: StorageBudget) -> None:
        self._database = database
        self._photos = photos
        self._budget = budget

    async def keep(self, keep: Keep, snapshot: Snapshot, photo: bytes) -> None:
        """Keep the picture of a recorded snapshot when its site wants it.

        A pose is worth more than its picture: one that cannot be kept is told to the log, and the answer stands.
        """
        if not keep.wants(located=isinstance(snapshot.outcome, Located)):
            return
        try:
            await asyncio.to_thread(self._keep, snapshot, photo)
        except ScattermarkError as error:
            log.warning("the picture of pose %s is not kept: %s", snapshot.pose_id, error.detail)

    def _keep(self, snapshot: Snapshot, photo: bytes) -> None:
        data = without_position(photo)
        kept = KeptSnapshot(
            pose_id=snapshot.pose_id,
            site_id=snapshot.heading.site_id,
            sha256=hashlib.sha256(data).hexdigest(),
            size_bytes=len(data),
            kept_s=time.time(),
        )
        self._budget.admit(len(data))
        self._photos.put(kept.sha256, data)
        with self._database.writing() as session:
            lock_photos(session, [kept.sha256])
            added = KeptSnapshotRepository(session).add(kept)
            # As in an upload: a purge may have taken the file while no row referred to it.
            if added and not self._photos.holds(kept.sha256):
                self._photos.put(kept.sha256, data)

    def picture(self, pose_id: str) -> Picture:
        """The kept picture of a snapshot.

        Raises
        ------
        NotFound
            When there is none.
        StorageUnavailable
        """
        with self._database.reading() as session:
            kept = KeptSnapshotRepository(session).of_pose(pose_id)
        data = self._photos.read(kept.sha256)
        return Picture(data, read_header(data, ANY_SIZE).format)
