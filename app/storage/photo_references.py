"""Who refers to photographs of the store: surveys' photographs and kept snapshots; and how much they come to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sqlalchemy import ColumnElement, Select, delete, exists, func, literal, select, union
from sqlalchemy.orm import Session
from sqlalchemy.sql import CompoundSelect

from app.storage.models import DetectionRow, KeptSnapshotRow, PhotographRow, SurveyRow

DIGITS_OF_LOCK = 15  # hexadecimal digits of a digest that name its lock: 60 bits, of Postgres's 63


@dataclass(frozen=True)
class SiteUsage:
    """What a site has in the store; a picture that two photographs share counts for both."""

    site_id: str
    photographs: int
    photographs_bytes: int
    kept_snapshots: int
    kept_bytes: int


def lock_photos(session: Session, digests: Iterable[str]) -> None:
    """Let nobody else decide about these photographs until the transaction ends: neither use nor remove them.

    On SQLite a writer is alone. On Postgres locks are taken in one order, so that no two wait for each other.
    """
    if session.get_bind().dialect.name != "postgresql":
        return
    for digest in sorted(set(digests)):
        session.execute(select(func.pg_advisory_xact_lock(int(digest[:DIGITS_OF_LOCK], 16))))


def referred_to(session: Session, digests: Sequence[str]) -> set[str]:
    """Those of the digests that a row refers to."""
    kinds = (PhotographRow.sha256, KeptSnapshotRow.sha256)
    return {digest for kind in kinds for digest in session.scalars(select(kind).where(kind.in_(digests)).distinct())}


def used_bytes(session: Session) -> int:
    """All that rows refer to, the same bytes counted once."""
    objects = _objects().subquery()
    return int(session.scalar(select(func.coalesce(func.sum(objects.c.size_bytes), 0))) or 0)


def _objects() -> CompoundSelect[str, int]:
    kept = select(KeptSnapshotRow.sha256, KeptSnapshotRow.size_bytes)
    return union(select(PhotographRow.sha256, PhotographRow.size_bytes), kept)


def usage_of_sites(session: Session) -> tuple[SiteUsage, ...]:
    """What each site has, by its id; sites without photographs are left out."""
    photos = _counted(
        select(SurveyRow.site_id, func.count(), func.sum(PhotographRow.size_bytes))
        .join(PhotographRow, PhotographRow.survey_id == SurveyRow.id)
        .group_by(SurveyRow.site_id),
        session,
    )
    kept = _counted(
        select(KeptSnapshotRow.site_id, func.count(), func.sum(KeptSnapshotRow.size_bytes)).group_by(
            KeptSnapshotRow.site_id
        ),
        session,
    )
    none = (0, 0)
    return tuple(
        SiteUsage(site_id, *photos.get(site_id, none), *kept.get(site_id, none)) for site_id in sorted({*photos, *kept})
    )


def _counted(query: Select[str, int, int], session: Session) -> dict[str, tuple[int, int]]:
    return {site_id: (count, int(size_bytes)) for site_id, count, size_bytes in session.execute(query)}


def _stray(older_than_s: float) -> tuple[ColumnElement[bool], ...]:
    held = exists().where(PhotographRow.sha256 == DetectionRow.sha256)
    return DetectionRow.created_s < older_than_s, ~held


def delete_stray_detections(session: Session, older_than_s: float) -> int:
    """Remove detections of photographs that no survey has; how many."""
    condition = _stray(older_than_s)
    return len(session.scalars(delete(DetectionRow).where(*condition).returning(literal(1))).all())


def count_stray_detections(session: Session, older_than_s: float) -> int:
    """How many detections are of photographs that no survey has."""
    return session.scalar(select(func.count()).select_from(DetectionRow).where(*_stray(older_than_s))) or 0
