"""Which targets took part of each photograph of a map: who looks at a target sees its photographs."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Forward; maps that were built before do not tell."""
    with op.batch_alter_table("map_photos") as batch_op:
        batch_op.add_column(sa.Column("codes", sa.JSON(), nullable=True))


def downgrade() -> None:
    """Back."""
    with op.batch_alter_table("map_photos") as batch_op:
        batch_op.drop_column("codes")
