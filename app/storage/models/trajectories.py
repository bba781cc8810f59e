"""Trajectories and their snapshots."""

from __future__ import annotations

from sqlalchemy import JSON, ForeignKey, Index, String, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Blob, Id, Json, Number, OfSite, Short


class TrajectoryRow(Base):
    """Snapshots of one device on one site, and what they come to: its row is locked while one is added."""

    __tablename__ = "trajectories"
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    device_id: Mapped[Short | None]
    name: Mapped[Short]
    default_key: Mapped[str | None] = mapped_column(Text(), unique=True)  # one open default per site and device
    created_s: Mapped[Number]
    closed_s: Mapped[Number | None]
    snapshot_count: Mapped[int]  # with those that were removed: ordinals are never given twice
    removed_count: Mapped[int] = mapped_column(default=0)
    failures: Mapped[Json]  # how many by reason
    first_s: Mapped[Number | None]
    last_s: Mapped[Number | None]
    # Of one that came as a file: its poses are no snapshots, and no row of them is ever added.
    source: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    imported_count: Mapped[int] = mapped_column(default=0)


class SnapshotRow(Base):
    """A located snapshot or a refusal. The numbers that queries ask for are columns; ``seen`` is for people."""

    __tablename__ = "snapshots"
    __table_args__ = (
        # In the order of pages; the rest is for filters, which then never read the rows.
        Index("ix_snapshots_by_time", "trajectory_id", "captured_s", "ordinal", "x_m", "y_m", "z_m", "sigma_m"),
        UniqueConstraint("trajectory_id", "ordinal"),
        UniqueConstraint("site_id", "snapshot_id"),
    )
    id: Mapped[Id]
    site_id: Mapped[str] = mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"))
    trajectory_id: Mapped[str] = mapped_column(String(36), ForeignKey("trajectories.id", ondelete="CASCADE"))
    ordinal: Mapped[int]  # 1, 2, ... in the order of arrival, without a gap: whoever has n asks for what follows n
    snapshot_id: Mapped[str | None] = mapped_column(String(36))
    device_id: Mapped[Short | None]
    map_version: Mapped[int]
    captured_s: Mapped[Number]
    received_s: Mapped[Number]
    time_source: Mapped[Short]
    clock_delay_s: Mapped[Number | None]
    reason: Mapped[Short | None]  # null: located
    x_m: Mapped[Number | None]
    y_m: Mapped[Number | None]
    z_m: Mapped[Number | None]
    sigma_m: Mapped[Number | None]  # the largest of the three
    rotation: Mapped[Blob | None]
    covariance: Mapped[Blob | None]
    seen: Mapped[Json]
