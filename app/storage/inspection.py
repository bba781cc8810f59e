"""What a database says of its own state: whether its file is whole, its rows fit together, its clock is right."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Double, Table, func, literal_column, select, text

from app.storage.database import Session
from app.storage.models import Base
from app.storage.workers import CLOCKS

PROBLEMS_SHOWN = 5
# Of each table the time at which its rows were written, by the clock of whoever wrote them.
WRITTEN_AT = ("created_s", "received_s", "at_s", "kept_s")


@dataclass(frozen=True)
class RowTime:
    """The latest time that a table's rows say they were written at, UTC seconds since 1970."""

    table: str
    latest_s: float


def file_faults(session: Session, *, deep: bool) -> tuple[str, ...]:
    """What SQLite finds wrong in its file; on Postgres, which checks its pages when it reads them, nothing.

    Parameters
    ----------
    deep : bool
        Compare each index with its table too: minutes for gigabytes.
    """
    if session.get_bind().dialect.name != "sqlite":
        return ()
    check = "integrity_check" if deep else "quick_check"
    found = session.execute(text(f"PRAGMA {check}({PROBLEMS_SHOWN})")).scalars().all()
    return () if found == ["ok"] else tuple(str(line) for line in found)


def lost_references(session: Session) -> tuple[str, ...]:
    """Tables with rows that refer to rows which are not there; Postgres lets none come about."""
    if session.get_bind().dialect.name != "sqlite":
        return ()
    rows = session.execute(text("PRAGMA foreign_key_check"))
    return tuple(sorted({f"{row[0]} -> {row[2]}" for row in rows}))


def journal_mode(session: Session) -> str | None:
    """How SQLite keeps its changes; None on Postgres."""
    if session.get_bind().dialect.name != "sqlite":
        return None
    return str(session.execute(text("PRAGMA journal_mode")).scalar_one())


def clock_s(session: Session) -> float:
    """The database's clock."""
    return float(session.scalar(select(literal_column(CLOCKS[session.get_bind().dialect.name], Double()))) or 0.0)


def latest_rows(session: Session) -> tuple[RowTime, ...]:
    """The youngest row of each table that says when it was written."""
    found = []
    for table in Base.metadata.sorted_tables:
        latest_s = _latest(session, table)
        if latest_s is not None:
            found.append(RowTime(table.name, latest_s))
    return tuple(found)


def _latest(session: Session, table: Table) -> float | None:
    columns = [table.columns[name] for name in WRITTEN_AT if name in table.columns]
    return session.scalar(select(func.max(columns[0]))) if columns else None
