"""How much photographs may take: a quota of them all, and room on the disk that is left to everybody else."""

from __future__ import annotations

from dataclasses import dataclass

from app.errors import OutOfSpace
from app.storage.database import Database
from app.storage.photo_references import SiteUsage, usage_of_sites, used_bytes
from app.storage.photo_store import PhotoStore

MEGABYTE = 1e6
ADVICE = "delete sites or kept snapshots that are not needed (`scattermark purge` then removes their files)"


@dataclass(frozen=True)
class StorageLimits:
    """What photographs may take.

    Attributes
    ----------
    quota_bytes : int
        All photographs together; 0 for no limit.
    min_free_bytes : int
        Room on the disk that an upload leaves.
    """

    quota_bytes: int = 0
    min_free_bytes: int = 0


@dataclass(frozen=True)
class StorageUsage:
    """What photographs take, and of what."""

    used_bytes: int
    free_bytes: int
    limits: StorageLimits
    sites: tuple[SiteUsage, ...]


class StorageBudget:
    """Looks before anything is written. Uploads that come at the same moment are not counted against each other."""

    def __init__(self, database: Database, photos: PhotoStore, limits: StorageLimits) -> None:
        self._database = database
        self._photos = photos
        self._limits = limits

    def admit(self, size_bytes: int) -> None:
        """See that there is room for so many bytes more.

        Raises
        ------
        OutOfSpace
        """
        free_bytes = self._photos.free_bytes()
        if free_bytes - size_bytes < self._limits.min_free_bytes:
            raise OutOfSpace(
                f"the disk has {free_bytes / MEGABYTE:.0f} MB left, of which SCATTERMARK_MIN_FREE_BYTES leaves "
                f"{self._limits.min_free_bytes / MEGABYTE:.0f} MB free: make room on it, or {ADVICE}",
                free_bytes=free_bytes,
                min_free_bytes=self._limits.min_free_bytes,
            )
        if self._limits.quota_bytes:
            self._check_quota(size_bytes)

    def _check_quota(self, size_bytes: int) -> None:
        with self._database.reading() as session:
            used = used_bytes(session)
        if used + size_bytes > self._limits.quota_bytes:
            raise OutOfSpace(
                f"photographs take {used / MEGABYTE:.0f} MB of the {self._limits.quota_bytes / MEGABYTE:.0f} MB that "
                f"SCATTERMARK_QUOTA_BYTES allows: raise it, or {ADVICE}",
                used_bytes=used,
                quota_bytes=self._limits.quota_bytes,
            )

    def usage(self) -> StorageUsage:
        """What photographs take now.

        Raises
        ------
        StorageUnavailable
        """
        with self._database.reading() as session:
            used, sites = used_bytes(session), usage_of_sites(session)
        return StorageUsage(used, self._photos.free_bytes(), self._limits, sites)
