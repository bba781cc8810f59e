"""Pictures of snapshots that a site keeps."""

from __future__ import annotations

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Digest, Number, Size


class KeptSnapshotRow(Base):
    """The picture of one snapshot; its bytes lie in the photo store under their digest."""

    __tablename__ = "kept_snapshots"
    __table_args__ = (Index(None, "site_id", "kept_s"),)
    pose_id: Mapped[str] = mapped_column(String(36), ForeignKey("snapshots.id", ondelete="CASCADE"), primary_key=True)
    site_id: Mapped[str] = mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"))
    sha256: Mapped[Digest] = mapped_column(index=True)
    size_bytes: Mapped[Size]
    kept_s: Mapped[Number]
