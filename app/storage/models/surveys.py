"""Surveys, their photographs, and what detectors saw in them."""

from __future__ import annotations

from sqlalchemy import ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Blob, Digest, Id, Json, Long, Number, OfSite, OfSurvey, Short, Size


class SurveyRow(Base):
    """One set of photographs."""

    __tablename__ = "surveys"
    id: Mapped[Id]
    site_id: Mapped[OfSite]
    note: Mapped[Long]
    device_id: Mapped[Short | None]
    created_s: Mapped[Number]


class PhotographRow(Base):
    """A photograph of a survey; its bytes lie in the photo store under ``sha256``.

    What was sent may have held a position, and had other bytes then: its digest is what the client knows.
    """

    __tablename__ = "photographs"
    __table_args__ = (UniqueConstraint("survey_id", "name"),)
    id: Mapped[Id]
    survey_id: Mapped[OfSurvey]
    name: Mapped[Short]
    sha256: Mapped[Digest] = mapped_column(index=True)
    size_bytes: Mapped[Size]
    sent_sha256: Mapped[Digest]
    sent_bytes: Mapped[Size]
    identity: Mapped[Json]
    captured_at: Mapped[Long | None]  # as the camera wrote it, which may be anything
    created_s: Mapped[Number]


class PhotoMarkRow(Base):
    """A dot that a person marked in a photograph of a survey."""

    __tablename__ = "photo_marks"
    survey_id: Mapped[str] = mapped_column(String(36), ForeignKey("surveys.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[Short] = mapped_column(primary_key=True)
    code: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    cell: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    x_px: Mapped[Number]
    y_px: Mapped[Number]
    sigma_px: Mapped[Number]


class DetectionRow(Base):
    """What one detector saw in one photograph: computed once, whatever survey the photograph is in."""

    __tablename__ = "detections"
    sha256: Mapped[Digest] = mapped_column(primary_key=True)
    detector: Mapped[Short] = mapped_column(primary_key=True)
    options_digest: Mapped[Digest] = mapped_column(primary_key=True)
    record: Mapped[Blob]
    created_s: Mapped[Number]
