"""Snapshots that a site keeps, and for how long; photographs are known by what was sent and by what is stored."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

ID, SHORT, DIGEST = sa.String(36), sa.String(200), sa.String(64)


def upgrade() -> None:
    """Forward."""
    _tell_sent_from_stored()
    with op.batch_alter_table("sites") as batch_op:
        batch_op.add_column(sa.Column("keep_snapshots", SHORT, nullable=False, server_default="none"))
        batch_op.add_column(sa.Column("snapshot_retention_s", sa.Double(), nullable=True))
    with op.batch_alter_table("trajectories") as batch_op:
        batch_op.add_column(sa.Column("removed_count", sa.Integer(), nullable=False, server_default="0"))
    op.create_table(
        "kept_snapshots",
        sa.Column("pose_id", ID, nullable=False),
        sa.Column("site_id", ID, nullable=False),
        sa.Column("sha256", DIGEST, nullable=False),
        sa.Column("size_bytes", sa.BigInteger(), nullable=False),
        sa.Column("kept_s", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(
            ["pose_id"], ["snapshots.id"], name=op.f("fk_kept_snapshots_pose_id"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_kept_snapshots_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pose_id", name=op.f("pk_kept_snapshots")),
    )
    op.create_index(op.f("ix_kept_snapshots_sha256"), "kept_snapshots", ["sha256"])
    op.create_index(op.f("ix_kept_snapshots_site_id_kept_s"), "kept_snapshots", ["site_id", "kept_s"])
    for table, column in (("sites", "keep_snapshots"), ("trajectories", "removed_count")):
        with op.batch_alter_table(table) as batch_op:  # from here on the program says the first values
            batch_op.alter_column(column, server_default=None)


def _tell_sent_from_stored() -> None:
    """What was stored until now was stored as it had been sent."""
    with op.batch_alter_table("photographs") as batch_op:
        batch_op.add_column(sa.Column("sent_sha256", DIGEST, nullable=True))
        batch_op.add_column(sa.Column("sent_bytes", sa.BigInteger(), nullable=True))
    op.execute("UPDATE photographs SET sent_sha256 = sha256, sent_bytes = size_bytes")
    with op.batch_alter_table("photographs") as batch_op:
        batch_op.alter_column("sent_sha256", existing_type=DIGEST, nullable=False)
        batch_op.alter_column("sent_bytes", existing_type=sa.BigInteger(), nullable=False)


def downgrade() -> None:
    """Back."""
    op.drop_table("kept_snapshots")
    for table, columns in (
        ("trajectories", ["removed_count"]),
        ("sites", ["snapshot_retention_s", "keep_snapshots"]),
        ("photographs", ["sent_bytes", "sent_sha256"]),
    ):
        with op.batch_alter_table(table) as batch_op:
            for column in columns:
                batch_op.drop_column(column)
