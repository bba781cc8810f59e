"""Sites that came from elsewhere."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field

from app.services.site_transfer_import import ImportedSite

ARCHIVE = "application/zip"
ARCHIVE_CONTENT: dict[str, Any] = {ARCHIVE: {"schema": {"type": "string", "format": "binary"}}}
ARCHIVE_BODY: dict[str, Any] = {"required": True, "content": ARCHIVE_CONTENT}


class ImportedSiteAnswer(BaseModel):
    """A site that was taken in."""

    site_id: str
    rows: int
    photographs: int
    left_out: list[str] = Field(description="Names of photographs whose bytes the archive does not hold.")

    @classmethod
    def of(cls, imported: ImportedSite) -> ImportedSiteAnswer:
        """The answer."""
        return cls(
            site_id=imported.site_id,
            rows=imported.rows,
            photographs=imported.photographs,
            left_out=list(imported.left_out),
        )
