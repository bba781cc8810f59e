"""Pictures of snapshots that sites keep: which pose has one, and which are past their time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Select, delete, func, select
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.models import KeptSnapshotRow, SiteRow, SnapshotRow
from app.storage.upsert import insert_if_absent


@dataclass(frozen=True)
class KeptSnapshot:
    """The picture of a snapshot; its bytes are in the photo store, without any position on the Earth."""

    pose_id: str
    site_id: str
    sha256: str
    size_bytes: int
    kept_s: float


class KeptSnapshotRepository:
    """Kept pictures of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, kept: KeptSnapshot) -> bool:
        """Keep the picture of a snapshot; False when the snapshot is gone or has one already."""
        snapshot = select(SnapshotRow.id).where(SnapshotRow.id == kept.pose_id)
        # Locked, so that whoever deletes the snapshot deletes its picture too.
        if self._session.scalar(snapshot.with_for_update(read=True, key_share=True)) is None:
            return False
        return insert_if_absent(self._session, KeptSnapshotRow, **vars(kept))

    def of_pose(self, pose_id: str) -> KeptSnapshot:
        """The picture of a snapshot.

        Raises
        ------
        NotFound
            When there is none; also when there is no such snapshot.
        """
        row = self._session.get(KeptSnapshotRow, pose_id)
        if row is None:
            raise NotFound(
                f"no picture is kept of pose {pose_id}: its site keeps none of its kind (keep_snapshots), its time is "
                "over, or it was deleted",
                pose_id=pose_id,
            )
        return KeptSnapshot(row.pose_id, row.site_id, row.sha256, row.size_bytes, row.kept_s)

    def count_expired(self, now_s: float) -> int:
        """How many pictures are past their site's time."""
        return self._session.scalar(select(func.count()).select_from(_expired(now_s).subquery())) or 0

    def remove_expired(self, now_s: float, limit: int) -> Sequence[str]:
        """Forget some of the pictures that are past their site's time; their digests."""
        pose_ids = list(self._session.scalars(_expired(now_s).limit(limit)))
        chosen = KeptSnapshotRow.pose_id.in_(pose_ids)
        return self._session.scalars(delete(KeptSnapshotRow).where(chosen).returning(KeptSnapshotRow.sha256)).all()


def _expired(now_s: float) -> Select[str]:
    return (
        select(KeptSnapshotRow.pose_id)
        .join(SiteRow, SiteRow.id == KeptSnapshotRow.site_id)
        .where(KeptSnapshotRow.kept_s < now_s - SiteRow.snapshot_retention_s)
    )
