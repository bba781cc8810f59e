"""Alembic's entry: runs the migrations on the connection that ``app.storage.migrate`` hands over."""

from __future__ import annotations

from alembic import context

from app.storage.migrate import COMPARISON
from app.storage.models import Base

connection = context.config.attributes.get("connection")
if connection is None:
    raise SystemExit("run migrations with `scattermark migrate`: it knows the database")
context.configure(
    connection=connection,
    target_metadata=Base.metadata,
    render_as_batch=True,  # SQLite alters a table by copying it
    **COMPARISON,
)
with context.begin_transaction():
    context.run_migrations()
