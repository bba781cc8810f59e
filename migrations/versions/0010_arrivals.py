"""When positions of systems under test arrived: latency beside accuracy."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None

POSES = ("imported_poses", "evaluated_poses")


def upgrade() -> None:
    """Forward; samples that came before tell no arrival."""
    for table in POSES:
        with op.batch_alter_table(table) as batch_op:
            batch_op.add_column(sa.Column("arrived_s", sa.LargeBinary(), nullable=True))
    with op.batch_alter_table("live_samples") as batch_op:
        batch_op.add_column(sa.Column("arrived_s", sa.Double(), nullable=True))


def downgrade() -> None:
    """Back."""
    for table in (*POSES, "live_samples"):
        with op.batch_alter_table(table) as batch_op:
            batch_op.drop_column("arrived_s")
