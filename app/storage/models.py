"""The tables. Times are UTC seconds since 1970, arrays are little-endian float64 blobs (``blobs.py``)."""

from __future__ import annotations

from typing import Annotated, Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Double,
    ForeignKey,
    Index,
    LargeBinary,
    MetaData,
    String,
    Text,
    UniqueConstraint,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

# Every constraint has a name, so that a migration can find it on any database.
NAMING = {
    "ix": "ix_%(table_name)s_%(column_0_N_name)s",
    "uq": "uq_%(table_name)s_%(column_0_N_name)s",
    "fk": "fk_%(table_name)s_%(column_0_N_name)s",
    "pk": "pk_%(table_name)s",
}

Id = Annotated[str, mapped_column(String(36), primary_key=True)]
Short = Annotated[str, mapped_column(String(200))]
Long = Annotated[str, mapped_column(Text())]
Digest = Annotated[str, mapped_column(String(64))]
Number = Annotated[float, mapped_column(Double())]
Blob = Annotated[bytes, mapped_column(LargeBinary())]
Size = Annotated[int, mapped_column(BigInteger())]
Json = Annotated[dict[str, Any], mapped_column(JSON())]
JsonList = Annotated[list[Any], mapped_column(JSON())]
OfSite = Annotated[str, mapped_column(String(36), ForeignKey("sites.id", ondelete="CASCADE"), index=True)]
OfSurvey = Annotated[str, mapped_column(String(36), ForeignKey("surveys.id", ondelete="CASCADE"), index=True)]
OfMap = Annotated[str, mapped_column(String(36), ForeignKey("target_maps.id", ondelete="CASCADE"))]


class Base(DeclarativeBase):
    """Common ground of all tables."""

    metadata = MetaData(naming_convention=NAMING)


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


class SurveyRow(Base):
    """One set of photographs."""

    __tablename__ = "surveys"
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    note: Mapped[Long]
    device_id: Mapped[Short | None]
    created_s: Mapped[Number]


class PhotographRow(Base):
    """A photograph of a survey; its bytes lie in the photo store under their digest."""

    __tablename__ = "photographs"
    __table_args__ = (UniqueConstraint("survey_id", "name"),)
    id: Mapped[Id]
    survey_id: Mapped[OfSurvey]
    name: Mapped[Short]
    sha256: Mapped[Digest] = mapped_column(index=True)
    size_bytes: Mapped[Size]
    identity: Mapped[Json]
    captured_at: Mapped[Long | None]  # as the camera wrote it, which may be anything
    created_s: Mapped[Number]


class DetectionRow(Base):
    """What one detector saw in one photograph: computed once, whatever survey the photograph is in."""

    __tablename__ = "detections"
    sha256: Mapped[Digest] = mapped_column(primary_key=True)
    detector: Mapped[Short] = mapped_column(primary_key=True)
    options_digest: Mapped[Digest] = mapped_column(primary_key=True)
    record: Mapped[Blob]
    created_s: Mapped[Number]


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
    created_s: Mapped[Number]


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
    snapshot_count: Mapped[int]
    failures: Mapped[Json]  # how many by reason
    first_s: Mapped[Number | None]
    last_s: Mapped[Number | None]


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


class JobRow(Base):
    """A piece of background work and how far it is."""

    __tablename__ = "jobs"
    id: Mapped[Id]
    kind: Mapped[Short]
    site_id: Mapped[OfSite]
    survey_id: Mapped[OfSurvey]
    options: Mapped[Json]
    state: Mapped[Short] = mapped_column(index=True)
    stage: Mapped[Short]
    done: Mapped[int]
    total: Mapped[int]
    error: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    result: Mapped[Json | None] = mapped_column(JSON(none_as_null=True))
    owner: Mapped[Short | None]
    created_s: Mapped[Number]
    started_s: Mapped[Number | None]
    finished_s: Mapped[Number | None]
