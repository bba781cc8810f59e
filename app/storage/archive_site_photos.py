"""Photographs and detections of a scratch database: what is said of them is replaced by what they turn out to be."""

from __future__ import annotations

import io
import zlib
from dataclasses import asdict, dataclass
from zipfile import BadZipFile, ZipFile

from sqlalchemy import delete, select, update

from app.geometry.camera import CameraIdentity
from app.storage.archive_format import BadArchive
from app.storage.blobs import blob_of_detection, detection_of_blob
from app.storage.database import Session
from app.storage.models import DetectionRow, PhotographRow

MAX_DETECTION_BYTES = 2**26  # unpacked; five hundred targets with all that was refused have 2 MB


@dataclass(frozen=True)
class SeenPhoto:
    """A photograph as its own bytes describe it."""

    sha256: str
    size_bytes: int
    identity: CameraIdentity
    captured_at: str | None


def named_photos(session: Session) -> tuple[tuple[str, str], ...]:
    """Each photograph's name and digest."""
    query = select(PhotographRow.name, PhotographRow.sha256).order_by(PhotographRow.sha256, PhotographRow.name)
    return tuple((name, sha256) for name, sha256 in session.execute(query))


def describe_photo(session: Session, sha256: str, seen: SeenPhoto) -> None:
    """Say of the photographs that came under a digest what their bytes say."""
    values = {**asdict(seen), "identity": asdict(seen.identity)}
    session.execute(update(PhotographRow).where(PhotographRow.sha256 == sha256).values(**values))
    if seen.sha256 != sha256:  # other bytes are stored than came: the next build looks at them
        session.execute(delete(DetectionRow).where(DetectionRow.sha256 == sha256))


def leave_out_photo(session: Session, sha256: str) -> None:
    """Remove a photograph whose bytes did not come."""
    session.execute(delete(PhotographRow).where(PhotographRow.sha256 == sha256))
    session.execute(delete(DetectionRow).where(DetectionRow.sha256 == sha256))


def settle_detections(session: Session) -> None:
    """Read each detection and write it again as this program does; all must be of photographs that are there.

    Raises
    ------
    BadArchive
    """
    known = set(session.scalars(select(PhotographRow.sha256)))
    for row in session.scalars(select(DetectionRow).execution_options(yield_per=100)):
        if row.sha256 not in known:
            raise BadArchive(f"the archive holds a detection of photograph {row.sha256}, which is not in it")
        row.record = _rewritten(row.record)


def _rewritten(record: bytes) -> bytes:
    try:
        with ZipFile(io.BytesIO(record)) as arrays:
            if sum(entry.file_size for entry in arrays.infolist()) > MAX_DETECTION_BYTES:
                raise BadArchive(f"the archive holds a detection that unpacks to more than {MAX_DETECTION_BYTES} bytes")
        return blob_of_detection(detection_of_blob(record))
    except (BadZipFile, zlib.error, EOFError, ValueError, KeyError, TypeError, IndexError, RuntimeError) as error:
        raise BadArchive(f"the archive holds a detection that cannot be read ({error!r:.200})") from error
