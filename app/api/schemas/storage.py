"""What photographs take."""

from __future__ import annotations

from pydantic import BaseModel, Field

from app.services.storage_budget import StorageUsage


class SiteStorageAnswer(BaseModel):
    """What a site has in the store; a file that two photographs share counts for both."""

    site_id: str
    photographs: int
    photographs_bytes: int
    kept_snapshots: int
    kept_bytes: int


class StorageAnswer(BaseModel):
    """What photographs take, of what."""

    used_bytes: int = Field(description="All photographs and kept snapshots, the same bytes counted once.")
    quota_bytes: int | None = Field(description="What they may take together; null for no limit.")
    free_bytes: int = Field(description="Left on the disk that uploads go through.")
    min_free_bytes: int = Field(description="What uploads leave of it.")
    sites: list[SiteStorageAnswer]

    @classmethod
    def of(cls, usage: StorageUsage) -> StorageAnswer:
        """The answer for what is used."""
        return cls(
            used_bytes=usage.used_bytes,
            quota_bytes=usage.limits.quota_bytes or None,
            free_bytes=usage.free_bytes,
            min_free_bytes=usage.limits.min_free_bytes,
            sites=[SiteStorageAnswer(**vars(site)) for site in usage.sites],
        )
