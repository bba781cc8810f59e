"""Alembic's entry: runs the migrations on the connection that ``app.storage.migrate`` hands over."""

from __future__ import annotations

from alembic import context

from app.storage.models import Base


def include_name(name: str | None, kind: str, _parents: object) -> bool:
    """Compare our own tables only: a job engine may keep its own beside them."""
    return kind != "table" or name in Base.metadata.tables


connection = context.config.attributes.get("connection")
if connection is None:
    raise SystemExit("run migrations with `scattermark migrate`: it knows the database")
context.configure(
    connection=connection,
    target_metadata=Base.metadata,
    render_as_batch=True,  # SQLite alters a table by copying it
    include_name=include_name,
    compare_type=True,
)
with context.begin_transaction():
    context.run_migrations()
