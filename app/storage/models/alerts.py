"""What snapshots tell of their map, and the alerts that came of it."""

from __future__ import annotations

from sqlalchemy import ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Blob, Id, Json, Long, Number, Short


class EvidenceRow(Base):
    """What one snapshot tells of the map: numbers of its targets, without pixels; it goes when the snapshot goes."""

    __tablename__ = "map_evidence"
    __table_args__ = (Index(None, "site_id", "map_version", "pose_id"),)
    pose_id: Mapped[str] = mapped_column(String(36), ForeignKey("snapshots.id", ondelete="CASCADE"), primary_key=True)
    site_id: Mapped[str] = mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"))
    map_version: Mapped[int]
    captured_s: Mapped[Number]
    device_id: Mapped[Short | None]
    record: Mapped[Blob | None]  # null: its targets agreed on no pose


class AlertRow(Base):
    """One trouble of a map version: found, noticed by somebody, over."""

    __tablename__ = "alerts"
    __table_args__ = (UniqueConstraint("site_id", "map_version", "kind", "subject"),)
    id: Mapped[Id]
    site_id: Mapped[str] = mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"))
    map_version: Mapped[int]
    kind: Mapped[Short]
    subject: Mapped[Short]  # the code, or what is not about one target
    code: Mapped[int | None]
    severity: Mapped[Short]
    state: Mapped[Short] = mapped_column(index=True)
    raised_s: Mapped[Number]
    since_s: Mapped[Number]
    last_s: Mapped[Number]
    acknowledged_s: Mapped[Number | None]
    note: Mapped[Long]
    resolved_s: Mapped[Number | None]
    snapshot_count: Mapped[int]
    place_count: Mapped[int]
    device_count: Mapped[int]
    figures: Mapped[Json]
