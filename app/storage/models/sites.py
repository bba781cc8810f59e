"""Sites, their control points and their print batches."""

from __future__ import annotations

from sqlalchemy import JSON, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Id, Json, JsonList, Number, OfSite, Short


class SiteRow(Base):
    """A place whose targets share one frame and one code family."""

    __tablename__ = "sites"
    id: Mapped[Id]
    name: Mapped[Short]
    code_family: Mapped[Short]
    plate_u_m: Mapped[Number]
    geo_anchor: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    active_version: Mapped[int | None]
    last_version: Mapped[int]
    keep_snapshots: Mapped[Short] = mapped_column(default="none")
    snapshot_retention_s: Mapped[Number | None]
    created_s: Mapped[Number]


class ControlPointRow(Base):
    """A surveyed dot."""

    __tablename__ = "control_points"
    __table_args__ = (UniqueConstraint("site_id", "name"), UniqueConstraint("site_id", "code", "dot"))
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    ordinal: Mapped[int]
    name: Mapped[Short]
    code: Mapped[int]
    dot: Mapped[Short]
    x_m: Mapped[Number]
    y_m: Mapped[Number]
    z_m: Mapped[Number]
    sigma_m: Mapped[Number]
    role: Mapped[Short]


class PrintBatchRow(Base):
    """Sheets printed in one go, with the measured lengths of their check bars."""

    __tablename__ = "print_batches"
    __table_args__ = (UniqueConstraint("site_id", "name"),)
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    ordinal: Mapped[int]
    name: Mapped[Short]
    codes: Mapped[JsonList]
    bar_across_mm: Mapped[Number]
    bar_along_mm: Mapped[Number]
    sigma_mm: Mapped[Number]
