"""Background jobs."""

from __future__ import annotations

from sqlalchemy import JSON
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Id, Json, Number, OfSite, OfSurvey, Short


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
