"""What snapshots tell of their map, and alerts."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

ID, SHORT = sa.String(36), sa.String(200)


def upgrade() -> None:
    """Forward."""
    op.create_table(
        "map_evidence",
        sa.Column("pose_id", ID, nullable=False),
        sa.Column("site_id", ID, nullable=False),
        sa.Column("map_version", sa.Integer(), nullable=False),
        sa.Column("captured_s", sa.Double(), nullable=False),
        sa.Column("device_id", SHORT, nullable=True),
        sa.Column("record", sa.LargeBinary(), nullable=True),
        sa.ForeignKeyConstraint(
            ["pose_id"], ["snapshots.id"], name=op.f("fk_map_evidence_pose_id"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_map_evidence_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("pose_id", name=op.f("pk_map_evidence")),
    )
    columns = ["site_id", "map_version", "pose_id"]
    op.create_index(op.f("ix_map_evidence_site_id_map_version_pose_id"), "map_evidence", columns)
    _make_alerts()


def _make_alerts() -> None:
    op.create_table(
        "alerts",
        sa.Column("id", ID, nullable=False),
        sa.Column("site_id", ID, nullable=False),
        sa.Column("map_version", sa.Integer(), nullable=False),
        sa.Column("kind", SHORT, nullable=False),
        sa.Column("subject", SHORT, nullable=False),
        sa.Column("code", sa.Integer(), nullable=True),
        sa.Column("severity", SHORT, nullable=False),
        sa.Column("state", SHORT, nullable=False),
        *(sa.Column(name, sa.Double(), nullable=False) for name in ("raised_s", "since_s", "last_s")),
        sa.Column("acknowledged_s", sa.Double(), nullable=True),
        sa.Column("note", sa.Text(), nullable=False),
        sa.Column("resolved_s", sa.Double(), nullable=True),
        *(sa.Column(f"{name}_count", sa.Integer(), nullable=False) for name in ("snapshot", "place", "device")),
        sa.Column("figures", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_alerts_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_alerts")),
        sa.UniqueConstraint(
            "site_id", "map_version", "kind", "subject", name=op.f("uq_alerts_site_id_map_version_kind_subject")
        ),
    )
    op.create_index(op.f("ix_alerts_state"), "alerts", ["state"])


def downgrade() -> None:
    """Back."""
    op.drop_table("alerts")
    op.drop_table("map_evidence")
