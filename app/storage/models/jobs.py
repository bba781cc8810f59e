"""Background jobs and the processes that do them."""

from __future__ import annotations

from sqlalchemy import JSON
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Id, Json, Number, OfSite, OfSurvey, Short, Size


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
    owner: Mapped[Short | None]  # the worker that runs it
    attempt: Mapped[int]  # 1, and one more with each retry: what an earlier attempt still says is not heard
    strikes: Mapped[int]  # workers that died over it since it last got on
    created_s: Mapped[Number]
    started_s: Mapped[Number | None]
    finished_s: Mapped[Number | None]


class WorkerRow(Base):
    """A worker process that lives, or died without saying so."""

    __tablename__ = "workers"
    id: Mapped[Id]
    name: Mapped[Short]
    slot: Mapped[Short] = mapped_column(index=True)  # whoever has it locked knows that others of it are dead
    beats: Mapped[Size]  # counts up while it lives
    beat_s: Mapped[Number]  # by the database's clock
    started_s: Mapped[Number]
    left: Mapped[bool]  # it ended in order
