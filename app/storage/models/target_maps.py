"""Published target maps and the cameras that came with them."""

from __future__ import annotations

from sqlalchemy import ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Blob, Id, Json, JsonList, Long, Number, OfMap, OfSite, Short


class TargetMapRow(Base):
    """A published version of a site's target map; never changed."""

    __tablename__ = "target_maps"
    __table_args__ = (UniqueConstraint("site_id", "version"),)
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    version: Mapped[int]
    survey_id: Mapped[str | None] = mapped_column(String(36), ForeignKey("surveys.id", ondelete="SET NULL"))
    job_id: Mapped[str | None] = mapped_column(String(36), unique=True)  # one build publishes once
    base_version: Mapped[int | None]
    code_family: Mapped[Short]
    u_m: Mapped[Number]
    target_count: Mapped[int]
    datum_origin: Mapped[Blob]
    datum_covariance: Mapped[Blob]
    assumed_scale: Mapped[bool]
    assumed_orientation: Mapped[bool]
    report: Mapped[Json]
    created_s: Mapped[Number]


class MappedTargetRow(Base):
    """One target of a map version."""

    __tablename__ = "mapped_targets"
    map_id: Mapped[OfMap] = mapped_column(primary_key=True)
    code: Mapped[int] = mapped_column(primary_key=True)
    rotation: Mapped[Blob]
    position_m: Mapped[Blob]
    dots_m: Mapped[Blob]
    covariance: Mapped[Blob]
    rays: Mapped[int]
    rms_px: Mapped[Number]


class MapPhotoRow(Base):
    """What became of one photograph in a map's adjustment: its pose, or why it has none."""

    __tablename__ = "map_photos"
    map_id: Mapped[OfMap] = mapped_column(primary_key=True)
    name: Mapped[Short] = mapped_column(primary_key=True)
    camera_key: Mapped[Long | None]
    rotation: Mapped[Blob | None]
    position_m: Mapped[Blob | None]
    covariance: Mapped[Blob | None]
    rms_px: Mapped[Number | None]
    target_count: Mapped[int | None]
    codes: Mapped[JsonList | None]  # of the targets that took part; maps of earlier releases do not tell
    reason: Mapped[Long | None]


class CameraRow(Base):
    """A calibrated camera."""

    __tablename__ = "cameras"
    __table_args__ = (Index(None, "site_id", "created_s"), Index(None, "device_id", "created_s"))
    id: Mapped[Id]
    site_id: Mapped[str | None] = mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"))
    map_version: Mapped[int | None]
    device_id: Mapped[Short | None]
    source: Mapped[Short]
    identity: Mapped[Json]
    intrinsics: Mapped[Blob]
    covariance: Mapped[Blob]
    readout_s: Mapped[Number | None]  # of all rows, as the sensor lies
    created_s: Mapped[Number]
