"""Poses, trajectories and what was kept of them are removed on request, their pictures' files at once."""

from __future__ import annotations

from app.errors import InvalidInput
from app.services.photo_removal import remove_unused
from app.storage.database import Database
from app.storage.photo_store import PhotoStore
from app.storage.snapshot_removal import Removed, SnapshotFilter, SnapshotRemoval


class SnapshotEraser:
    """Removes snapshots: rows first, then the files that no row refers to any more.

    When the store gives no answer in between, the rows are gone and the next housekeeping removes the files.
    """

    def __init__(self, database: Database, photos: PhotoStore) -> None:
        self._database = database
        self._photos = photos

    def remove_pose(self, pose_id: str) -> None:
        """Remove one snapshot, located or refused.

        Raises
        ------
        NotFound, StorageUnavailable
        """
        with self._database.writing() as session:
            removed = SnapshotRemoval(session).pose(pose_id)
        self._remove_pictures(removed)

    def remove_trajectory(self, trajectory_id: str) -> None:
        """Remove a trajectory with its snapshots.

        Raises
        ------
        NotFound, StorageUnavailable
        """
        left = True
        while left:  # of a million snapshots no other writer shall wait for all
            with self._database.writing() as session:
                removed = SnapshotRemoval(session).some_of_trajectory(trajectory_id)
            self._remove_pictures(removed)
            left = removed.count > 0
        with self._database.writing() as session:
            removed = SnapshotRemoval(session).trajectory(trajectory_id)
        self._remove_pictures(removed)

    def remove_snapshots(self, wanted: SnapshotFilter) -> int:
        """Remove a site's snapshots of one device, before one time, or both; how many.

        A device that is removed whole loses its empty trajectories as well.

        Raises
        ------
        InvalidInput
            When neither is named.
        NotFound, StorageUnavailable
        """
        if wanted.device_id is None and wanted.before_s is None:
            raise InvalidInput(
                "name device_id, before or both; DELETE /sites/{site_id} removes a site with all it has",
                field="device_id",
            )
        count = 0
        while True:
            with self._database.writing() as session:
                removed = SnapshotRemoval(session).some(wanted)
                if removed is None:
                    break
            self._remove_pictures(removed)
            count += removed.count
        if wanted.device_id is not None and wanted.before_s is None:
            with self._database.writing() as session:
                SnapshotRemoval(session).empty_trajectories(wanted.site_id, wanted.device_id)
        return count

    def _remove_pictures(self, removed: Removed) -> None:
        remove_unused(self._database, self._photos, removed.pictures)
