"""What there is in the database, counted for operators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from app.storage.models import JobRow, PhotographRow


@dataclass(frozen=True)
class StoredFigures:
    """Counts at one moment.

    Attributes
    ----------
    jobs : mapping of (kind, state) to int
    oldest_queued_s : float or None
        When the job that waits longest was asked for, UTC seconds.
    photographs, photograph_bytes : int
        Photographs that surveys hold, the same bytes counted once.
    """

    jobs: Mapping[tuple[str, str], int]
    oldest_queued_s: float | None
    photographs: int
    photograph_bytes: int


def stored_figures(session: Session) -> StoredFigures:
    """Count what the database holds."""
    by_state = select(JobRow.kind, JobRow.state, func.count()).group_by(JobRow.kind, JobRow.state)
    oldest = select(func.min(JobRow.created_s)).where(JobRow.state == "queued")
    photos = select(PhotographRow.sha256, func.max(PhotographRow.size_bytes).label("bytes"))
    distinct = photos.group_by(PhotographRow.sha256).subquery()
    count, size_bytes = session.execute(select(func.count(), func.sum(distinct.c.bytes)).select_from(distinct)).one()
    return StoredFigures(
        jobs={(kind, state): number for kind, state, number in session.execute(by_state)},
        oldest_queued_s=session.scalar(oldest),
        photographs=count,
        photograph_bytes=int(size_bytes or 0),
    )
