"""Imported poses, evaluations with the pairs that they rest on, and live evaluations with their samples."""

from __future__ import annotations

from sqlalchemy import JSON, ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Blob, Id, Json, JsonList, Number, OfSite, Short


class PoseColumns:
    """Some thousand consecutive poses as arrays (``app.storage.pose_blobs``)."""

    pose_count: Mapped[int]
    times_s: Mapped[Blob]
    positions_m: Mapped[Blob]
    orientations_xyzw: Mapped[Blob | None]
    covariances: Mapped[Blob | None]
    floors: Mapped[Blob | None]
    arrived_s: Mapped[Blob | None]


class ImportedPosesRow(PoseColumns, Base):
    """Consecutive poses of a trajectory that came as a file; the numbers are bounds for whoever looks for some."""

    __tablename__ = "imported_poses"
    trajectory_id: Mapped[str] = mapped_column(
        String(36), ForeignKey("trajectories.id", ondelete="CASCADE"), primary_key=True
    )
    ordinal: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)  # of the first of them, from 1
    first_s: Mapped[Number]
    last_s: Mapped[Number]
    least_x_m: Mapped[Number]
    least_y_m: Mapped[Number]
    least_z_m: Mapped[Number]
    greatest_x_m: Mapped[Number]
    greatest_y_m: Mapped[Number]
    greatest_z_m: Mapped[Number]
    least_sigma_m: Mapped[Number | None]  # the best pose's; null without covariances


class EvaluationRow(Base):
    """Systems beside a reference."""

    __tablename__ = "evaluations"
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    reference_id: Mapped[str | None] = mapped_column(String(36), ForeignKey("trajectories.id", ondelete="SET NULL"))
    reference_name: Mapped[Short]
    title: Mapped[Short]
    options: Mapped[Json]
    differences: Mapped[JsonList]
    created_s: Mapped[Number]


class EvaluatedSystemRow(Base):
    """One system of an evaluation and what came out for it."""

    __tablename__ = "evaluated_systems"
    evaluation_id: Mapped[str] = mapped_column(
        String(36), ForeignKey("evaluations.id", ondelete="CASCADE"), primary_key=True
    )
    ordinal: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    trajectory_id: Mapped[str | None] = mapped_column(String(36), ForeignKey("trajectories.id", ondelete="SET NULL"))
    name: Mapped[Short]
    record: Mapped[Json]


class EvaluatedPosesRow(PoseColumns, Base):
    """Consecutive pairs of a system: the reference's side or the aligned estimate's."""

    __tablename__ = "evaluated_poses"
    evaluation_id: Mapped[str] = mapped_column(
        String(36), ForeignKey("evaluations.id", ondelete="CASCADE"), primary_key=True
    )
    system: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    side: Mapped[Short] = mapped_column(primary_key=True)  # reference or estimate
    ordinal: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)  # of the first of them, from 1
    estimate_rows: Mapped[Blob | None]  # of the whole estimate; on its own side alone


class LiveEvaluationRow(Base):
    """A system that is compared while its reference is being located: its row is locked while samples are paired."""

    __tablename__ = "live_evaluations"
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    reference_id: Mapped[str] = mapped_column(String(36), ForeignKey("trajectories.id", ondelete="CASCADE"), index=True)
    name: Mapped[Short]
    options: Mapped[Json]
    created_s: Mapped[Number]
    closed_s: Mapped[Number | None]
    sample_count: Mapped[int]
    pair_count: Mapped[int]
    missed_count: Mapped[int]
    seen_ordinal: Mapped[int]  # of the reference's snapshots, those that waiting samples were compared with


class LiveSampleRow(Base):
    """A position that a running system sent."""

    __tablename__ = "live_samples"
    __table_args__ = (
        UniqueConstraint("live_id", "time_s"),
        UniqueConstraint("live_id", "pair"),
        Index(None, "live_id", "state", "time_s"),
    )
    id: Mapped[Id]
    live_id: Mapped[str] = mapped_column(String(36), ForeignKey("live_evaluations.id", ondelete="CASCADE"))
    time_s: Mapped[Number]
    x_m: Mapped[Number]
    y_m: Mapped[Number]
    z_m: Mapped[Number | None]  # null for a system that tells the plan alone; the error has none then either
    floor: Mapped[int | None]
    orientation_xyzw: Mapped[JsonList | None] = mapped_column(JSON(none_as_null=True))
    arrived_s: Mapped[Number | None]  # at the server; null for those that came before this was kept
    state: Mapped[Short]  # waiting, paired or missed
    pair: Mapped[int | None]  # 1, 2, ... in the order in which pairs were found: the id of their events
    error_x_m: Mapped[Number | None]
    error_y_m: Mapped[Number | None]
    error_z_m: Mapped[Number | None]
    angle_rad: Mapped[Number | None]
    reference_sigma_m: Mapped[Number | None]  # the largest of the three
    right_floor: Mapped[bool | None]
