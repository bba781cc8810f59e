"""Worker processes in the database: each counts up while it lives, and others see whether it still does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

from sqlalchemy import CursorResult, Double, delete, literal_column, select, update
from sqlalchemy.orm import Session
from sqlalchemy.sql.elements import ColumnElement

from app.storage.ids import new_id
from app.storage.models import WorkerRow

# The database's clock, UTC seconds since 1970: all who write or compare a beat share it, whatever their own clocks say.
CLOCKS = {
    "postgresql": "extract(epoch FROM clock_timestamp())::double precision",
    "sqlite": "((julianday('now') - 2440587.5) * 86400.0)",  # the Julian day of 1970-01-01
}
LIVE_S = 10.0  # five beats; for those who look from outside. Whether one is dead, its peers decide by counting


@dataclass(frozen=True)
class Worker:
    """A worker process.

    Attributes
    ----------
    name : str
        Machine and place on it, for people.
    slot : str
        A place that only one process has at a time.
    beats : int
        Counts up while it lives.
    age_s : float
        Since its last beat, by the database's clock.
    left : bool
        It ended in order: what it did not finish is free at once.
    """

    worker_id: str
    name: str
    slot: str
    beats: int
    age_s: float
    left: bool

    @property
    def live(self) -> bool:
        """Whether it seems to live: a figure for operators, nothing is taken from a worker because of it."""
        return not self.left and self.age_s < LIVE_S


class WorkerRepository:
    """Workers of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, name: str, slot: str) -> str:
        """A new worker; its id."""
        worker_id, now = new_id(), self._now()
        row = WorkerRow(id=worker_id, name=name, slot=slot, beats=0, beat_s=now, started_s=now, left=False)
        self._session.add(row)
        self._session.flush()
        return worker_id

    def beat(self, worker_id: str) -> bool:
        """Say that a worker lives; False when the others have given it up."""
        values = {"beats": WorkerRow.beats + 1, "beat_s": self._now()}
        return self._change(update(WorkerRow).where(WorkerRow.id == worker_id).values(**values))

    def leave(self, worker_id: str) -> None:
        """Say that a worker ends in order."""
        self._change(update(WorkerRow).where(WorkerRow.id == worker_id).values(left=True))

    def lock(self, worker_id: str) -> bool:
        """Keep others from a worker's row until the transaction ends; False when it is gone."""
        query = select(WorkerRow.id).where(WorkerRow.id == worker_id).with_for_update()
        return self._session.scalar(query) is not None

    def remove(self, worker_id: str) -> None:
        """Forget a worker."""
        self._change(delete(WorkerRow).where(WorkerRow.id == worker_id))

    def workers(self) -> tuple[Worker, ...]:
        """All workers that were not removed, the oldest first."""
        age_s = (self._now() - WorkerRow.beat_s).label("age_s")
        rows = self._session.execute(select(WorkerRow, age_s).order_by(WorkerRow.id))
        return tuple(
            Worker(row.id, row.name, row.slot, row.beats, max(0.0, float(age_s)), row.left) for row, age_s in rows
        )

    def live_workers(self) -> tuple[Worker, ...]:
        """Workers that seem to live."""
        return tuple(worker for worker in self.workers() if worker.live)

    def _now(self) -> ColumnElement[float]:
        return literal_column(CLOCKS[self._session.get_bind().dialect.name], Double())

    def _change(self, statement: Any) -> bool:
        result = self._session.execute(statement, execution_options={"synchronize_session": False})
        return cast("CursorResult[Any]", result).rowcount == 1
