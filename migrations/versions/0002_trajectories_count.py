"""Trajectories count their snapshots, and each snapshot knows the how-manieth it is."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

BY_TIME = ["trajectory_id", "captured_s", "ordinal", "x_m", "y_m", "z_m", "sigma_m"]
ARRIVALS = "row_number() OVER (PARTITION BY trajectory_id ORDER BY id)"  # ids sort by the time they were made
TOTALS = """
UPDATE trajectories SET
    snapshot_count = (SELECT count(*) FROM snapshots WHERE snapshots.trajectory_id = trajectories.id),
    first_s = (SELECT min(captured_s) FROM snapshots WHERE snapshots.trajectory_id = trajectories.id),
    last_s = (SELECT max(captured_s) FROM snapshots WHERE snapshots.trajectory_id = trajectories.id)
"""
REASONS = (
    "SELECT trajectory_id, reason, count(*) FROM snapshots WHERE reason IS NOT NULL GROUP BY trajectory_id, reason"
)

trajectories = sa.table("trajectories", sa.column("id", sa.String()), sa.column("failures", sa.JSON()))


def upgrade() -> None:
    """Forward."""
    with op.batch_alter_table("trajectories") as batch_op:
        batch_op.add_column(sa.Column("snapshot_count", sa.Integer(), nullable=False, server_default="0"))
        batch_op.add_column(sa.Column("failures", sa.JSON(), nullable=False, server_default="{}"))
        batch_op.add_column(sa.Column("first_s", sa.Double(), nullable=True))
        batch_op.add_column(sa.Column("last_s", sa.Double(), nullable=True))
    with op.batch_alter_table("snapshots") as batch_op:
        batch_op.add_column(sa.Column("ordinal", sa.Integer(), nullable=True))
    _count()
    with op.batch_alter_table("trajectories") as batch_op:  # from here on the program says the first values
        batch_op.alter_column("snapshot_count", server_default=None)
        batch_op.alter_column("failures", server_default=None)
    with op.batch_alter_table("snapshots") as batch_op:
        batch_op.alter_column("ordinal", existing_type=sa.Integer(), nullable=False)
        batch_op.drop_index(batch_op.f("ix_snapshots_trajectory_id_captured_s"))
        batch_op.create_index("ix_snapshots_by_time", BY_TIME)
        batch_op.create_unique_constraint(
            batch_op.f("uq_snapshots_trajectory_id_ordinal"), ["trajectory_id", "ordinal"]
        )


def _count() -> None:
    """What the program keeps from now on, for what is there already."""
    numbered = f"(SELECT id AS numbered_id, {ARRIVALS} AS arrival FROM snapshots) AS numbered"
    op.execute(f"UPDATE snapshots SET ordinal = arrival FROM {numbered} WHERE snapshots.id = numbered_id")
    op.execute(TOTALS)
    failures: dict[str, dict[str, int]] = {}
    for trajectory_id, reason, count in op.get_bind().execute(sa.text(REASONS)):
        failures.setdefault(trajectory_id, {})[reason] = count
    for trajectory_id, counts in failures.items():
        op.execute(trajectories.update().where(trajectories.c.id == trajectory_id).values(failures=counts))


def downgrade() -> None:
    """Back."""
    with op.batch_alter_table("snapshots") as batch_op:
        batch_op.drop_constraint(batch_op.f("uq_snapshots_trajectory_id_ordinal"), type_="unique")
        batch_op.drop_index("ix_snapshots_by_time")
        batch_op.create_index(batch_op.f("ix_snapshots_trajectory_id_captured_s"), ["trajectory_id", "captured_s"])
        batch_op.drop_column("ordinal")
    with op.batch_alter_table("trajectories") as batch_op:
        batch_op.drop_column("last_s")
        batch_op.drop_column("first_s")
        batch_op.drop_column("failures")
        batch_op.drop_column("snapshot_count")
