"""What there is in the database, counted for operators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from app.storage.alerts import STANDING
from app.storage.models import AlertRow, JobRow, KeptSnapshotRow, PhotographRow
from app.storage.photo_references import used_bytes
from app.storage.workers import WorkerRepository


@dataclass(frozen=True)
class StoredFigures:
    """Counts at one moment.

    Attributes
    ----------
    jobs : mapping of (kind, state) to int
    oldest_queued_s : float or None
        When the job that waits longest was asked for, UTC seconds.
    live_workers : int
    standing_alerts : mapping of (kind, severity) to int
        Of all sites, open and acknowledged ones.
    photographs, kept_snapshots, stored_bytes : int
        Photographs of surveys and snapshots that were kept, and what they take together; equal ones count once.
    """

    jobs: Mapping[tuple[str, str], int]
    oldest_queued_s: float | None
    live_workers: int
    standing_alerts: Mapping[tuple[str, str], int]
    photographs: int
    kept_snapshots: int
    stored_bytes: int


def stored_figures(session: Session) -> StoredFigures:
    """Count what the database holds."""
    by_state = select(JobRow.kind, JobRow.state, func.count()).group_by(JobRow.kind, JobRow.state)
    oldest = select(func.min(JobRow.created_s)).where(JobRow.state == "queued")
    standing = select(AlertRow.kind, AlertRow.severity, func.count()).where(AlertRow.state.in_(STANDING))
    standing = standing.group_by(AlertRow.kind, AlertRow.severity)
    return StoredFigures(
        jobs={(kind, state): number for kind, state, number in session.execute(by_state)},
        oldest_queued_s=session.scalar(oldest),
        live_workers=len(WorkerRepository(session).live_workers()),
        standing_alerts={(kind, severity): number for kind, severity, number in session.execute(standing)},
        photographs=_distinct(session, PhotographRow.sha256),
        kept_snapshots=_distinct(session, KeptSnapshotRow.sha256),
        stored_bytes=used_bytes(session),
    )


def _distinct(session: Session, column: InstrumentedAttribute[str]) -> int:
    return session.scalar(select(func.count(column.distinct()))) or 0
