"""Print batches of a site: the check bars of their sheets as somebody measured them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Forward."""
    op.create_table(
        "print_batches",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("ordinal", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("codes", sa.JSON(), nullable=False),
        sa.Column("bar_across_mm", sa.Double(), nullable=False),
        sa.Column("bar_along_mm", sa.Double(), nullable=False),
        sa.Column("sigma_mm", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_print_batches_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_print_batches")),
        sa.UniqueConstraint("site_id", "name", name=op.f("uq_print_batches_site_id_name")),
    )
    op.create_index(op.f("ix_print_batches_site_id"), "print_batches", ["site_id"])


def downgrade() -> None:
    """Back."""
    op.drop_index(op.f("ix_print_batches_site_id"), "print_batches")
    op.drop_table("print_batches")
