"""What every archive is made of, a backup's or a site's: its heading and its photographs."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from importlib.metadata import version

from app.errors import NotFound
from app.storage.archive_format import Heading, Kind, Progress
from app.storage.archive_writer import ArchiveWriter
from app.storage.photo_store import PhotoStore


def heading_of(kind: Kind, revision: str) -> Heading:
    """The heading of an archive that is being made now."""
    return Heading(kind, revision, version("scattermark"), time.time())


def write_photos(
    writer: ArchiveWriter, photos: PhotoStore, digests: Sequence[str], report: Progress
) -> tuple[str, ...]:
    """Add photographs; the digests of those that the store does not hold, or holds altered."""
    missing = []
    for done, sha256 in enumerate(digests):
        report("photographs", done, len(digests))
        data = unaltered(photos, sha256)
        if data is None:
            missing.append(sha256)
        else:
            writer.add_photo(sha256, data)
    report("photographs", len(digests), len(digests))
    return tuple(missing)


def unaltered(photos: PhotoStore, sha256: str) -> bytes | None:
    """The bytes of a photograph; None when the store has lost it, or holds other bytes under its name."""
    try:
        data = photos.read(sha256)
    except NotFound:
        return None
    return data if hashlib.sha256(data).hexdigest() == sha256 else None
