"""How a camera's sensor is read: pictures of a rolling shutter that moves are located by it."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Forward."""
    with op.batch_alter_table("cameras") as batch_op:
        batch_op.add_column(sa.Column("readout_s", sa.Double(), nullable=True))


def downgrade() -> None:
    """Back."""
    with op.batch_alter_table("cameras") as batch_op:
        batch_op.drop_column("readout_s")
