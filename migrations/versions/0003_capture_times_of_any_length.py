"""A photograph's time is kept as its camera wrote it, however long: Postgres refuses what a column cannot hold."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

SHORT = 200


def upgrade() -> None:
    """Forward."""
    with op.batch_alter_table("photographs") as batch_op:
        batch_op.alter_column("captured_at", existing_type=sa.String(SHORT), type_=sa.Text())


def downgrade() -> None:
    """Back."""
    op.execute(f"UPDATE photographs SET captured_at = substr(captured_at, 1, {SHORT})")
    with op.batch_alter_table("photographs") as batch_op:
        batch_op.alter_column("captured_at", existing_type=sa.Text(), type_=sa.String(SHORT))
