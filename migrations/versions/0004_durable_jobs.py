"""Durable builds: attempts and strikes of a job, and the processes that do the work."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Forward. A build that ran in the server of before is put back into the queue: a worker begins it again."""
    with op.batch_alter_table("jobs") as batch_op:
        batch_op.add_column(sa.Column("attempt", sa.Integer(), nullable=False, server_default="1"))
        batch_op.add_column(sa.Column("strikes", sa.Integer(), nullable=False, server_default="0"))
    with op.batch_alter_table("jobs") as batch_op:  # from here on the program says the first values
        batch_op.alter_column("attempt", existing_type=sa.Integer(), server_default=None)
        batch_op.alter_column("strikes", existing_type=sa.Integer(), server_default=None)
    op.execute("UPDATE jobs SET state = 'queued', owner = NULL WHERE state = 'running'")
    op.create_table(
        "workers",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("slot", sa.String(length=200), nullable=False),
        sa.Column("beats", sa.BigInteger(), nullable=False),
        sa.Column("beat_s", sa.Double(), nullable=False),
        sa.Column("started_s", sa.Double(), nullable=False),
        sa.Column("left", sa.Boolean(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_workers")),
    )
    op.create_index(op.f("ix_workers_slot"), "workers", ["slot"])


def downgrade() -> None:
    """Back."""
    op.drop_table("workers")
    with op.batch_alter_table("jobs") as batch_op:
        batch_op.drop_column("strikes")
        batch_op.drop_column("attempt")
