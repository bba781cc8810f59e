"""What the snapshots of a map tell of it, as it is kept: the newest of each version."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from app.photogrammetry.map_watch import WatchedSnapshot
from app.storage.evidence_blob import evidence_of_blob
from app.storage.models import EvidenceRow, SnapshotRow


@dataclass(frozen=True)
class EvidenceState:
    """How many snapshots tell of a map and which came last: equal as long as nothing new is told."""

    count: int
    newest_id: str | None


@dataclass(frozen=True)
class KeptEvidence:
    """A snapshot that tells of a map: its pose's id and trajectory, and what it tells."""

    pose_id: str
    trajectory_id: str
    snapshot: WatchedSnapshot


class EvidenceRepository:
    """Evidence of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def state(self, site_id: str, map_version: int) -> EvidenceState:
        """What there is of a map version."""
        query = select(func.count(), func.max(EvidenceRow.pose_id)).where(
            EvidenceRow.site_id == site_id, EvidenceRow.map_version == map_version
        )
        count, newest_id = self._session.execute(query).one()
        return EvidenceState(count, newest_id)

    def newest(self, site_id: str, map_version: int, limit: int) -> tuple[WatchedSnapshot, ...]:
        """The last so many that came, the newest first."""
        query = (
            select(EvidenceRow)
            .where(EvidenceRow.site_id == site_id, EvidenceRow.map_version == map_version)
            .order_by(EvidenceRow.pose_id.desc())
            .limit(limit)
        )
        return tuple(_snapshot(row) for row in self._session.scalars(query))

    def between(self, site_id: str, map_version: int, span_s: tuple[float, float]) -> Iterator[KeptEvidence]:
        """Those that were taken in a span of time, both ends included, the newest first."""
        query = (
            select(EvidenceRow, SnapshotRow.trajectory_id)
            .join(SnapshotRow, SnapshotRow.id == EvidenceRow.pose_id)
            .where(EvidenceRow.site_id == site_id, EvidenceRow.map_version == map_version)
            .where(EvidenceRow.captured_s.between(*span_s))
            .order_by(EvidenceRow.captured_s.desc(), EvidenceRow.pose_id.desc())
        )
        for row, trajectory_id in self._session.execute(query):
            yield KeptEvidence(row.pose_id, trajectory_id, _snapshot(row))

    def watched_maps(self) -> tuple[tuple[str, int], ...]:
        """Sites and map versions of which something is told."""
        query = select(EvidenceRow.site_id, EvidenceRow.map_version).distinct()
        return tuple((site_id, version) for site_id, version in self._session.execute(query))

    def forget_older(self, site_id: str, map_version: int, keep: int) -> int:
        """Remove all but the newest so many of a map version; how many went."""
        of_map = (EvidenceRow.site_id == site_id, EvidenceRow.map_version == map_version)
        oldest = select(EvidenceRow.pose_id).where(*of_map).order_by(EvidenceRow.pose_id.desc()).offset(keep).limit(1)
        first_to_go = self._session.scalar(oldest)
        if first_to_go is None:
            return 0
        gone = delete(EvidenceRow).where(*of_map, EvidenceRow.pose_id <= first_to_go).returning(EvidenceRow.pose_id)
        return len(self._session.scalars(gone).all())


def _snapshot(row: EvidenceRow) -> WatchedSnapshot:
    evidence = None if row.record is None else evidence_of_blob(row.record)
    return WatchedSnapshot(row.captured_s, row.device_id, evidence)
