"""Insert unless it is there: the one statement whose spelling SQLite and Postgres keep in different modules."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from sqlalchemy import Connection, Executable, Table, literal
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from app.storage.models import Base


def insert_if_absent(session: Session, model: type[Base], **values: Any) -> bool:
    """Insert a row; False, and nothing changed, when a unique column already holds these values.

    Unlike looking first, it is right when two writers come at once.
    """
    statement = _statement(model, session.get_bind().dialect.name)
    return session.execute(statement, values).first() is not None


def insert_what_is_absent(connection: Connection, model: type[Base], rows: Sequence[dict[str, Any]]) -> int:
    """Insert those rows whose unique columns nobody holds yet; how many they were."""
    inserted = connection.execute(_statement(model, connection.dialect.name), rows)
    return len(inserted.all())


@cache
def _statement(model: type[Base], dialect: str) -> Executable:
    """Built once: for a pose row that takes longer than its execution."""
    table = model.__table__
    assert isinstance(table, Table)
    insert = postgresql.insert if dialect == "postgresql" else sqlite.insert
    # What comes back is the inserted row; the count of rows is not told by every driver.
    return insert(table).on_conflict_do_nothing().returning(literal(1))
