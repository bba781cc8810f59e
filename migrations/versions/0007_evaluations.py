"""Trajectories that came as files, evaluations, and live evaluations."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

ID, SHORT = sa.String(36), sa.String(200)
BOUNDS = ("first_s", "last_s", *(f"{end}_{axis}_m" for end in ("least", "greatest") for axis in "xyz"))
ERRORS = ("error_x_m", "error_y_m", "error_z_m", "angle_rad", "reference_sigma_m")


def upgrade() -> None:
    """Forward."""
    with op.batch_alter_table("trajectories") as batch_op:
        batch_op.add_column(sa.Column("source", sa.JSON(none_as_null=True), nullable=True))
        batch_op.add_column(sa.Column("imported_count", sa.Integer(), nullable=False, server_default="0"))
    with op.batch_alter_table("trajectories") as batch_op:  # from here on the program says the first value
        batch_op.alter_column("imported_count", server_default=None)
    op.create_table(
        "imported_poses",
        sa.Column("trajectory_id", ID, nullable=False),
        sa.Column("ordinal", sa.Integer(), nullable=False),
        *(sa.Column(name, sa.Double(), nullable=False) for name in BOUNDS),
        sa.Column("least_sigma_m", sa.Double(), nullable=True),
        *_poses(),
        _of("imported_poses", "trajectory_id", "trajectories"),
        sa.PrimaryKeyConstraint("trajectory_id", "ordinal", name=op.f("pk_imported_poses")),
    )
    _make_evaluations()
    _make_live_evaluations()


def _make_evaluations() -> None:
    op.create_table(
        "evaluations",
        sa.Column("id", ID, nullable=False),
        sa.Column("site_id", ID, nullable=False),
        sa.Column("reference_id", ID, nullable=True),
        sa.Column("reference_name", SHORT, nullable=False),
        sa.Column("title", SHORT, nullable=False),
        sa.Column("options", sa.JSON(), nullable=False),
        sa.Column("differences", sa.JSON(), nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        _of("evaluations", "site_id", "sites"),
        _of("evaluations", "reference_id", "trajectories", "SET NULL"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_evaluations")),
    )
    op.create_index(op.f("ix_evaluations_site_id"), "evaluations", ["site_id"])
    op.create_table(
        "evaluated_systems",
        sa.Column("evaluation_id", ID, nullable=False),
        sa.Column("ordinal", sa.Integer(), nullable=False),
        sa.Column("trajectory_id", ID, nullable=True),
        sa.Column("name", SHORT, nullable=False),
        sa.Column("record", sa.JSON(), nullable=False),
        _of("evaluated_systems", "evaluation_id", "evaluations"),
        _of("evaluated_systems", "trajectory_id", "trajectories", "SET NULL"),
        sa.PrimaryKeyConstraint("evaluation_id", "ordinal", name=op.f("pk_evaluated_systems")),
    )
    op.create_table(
        "evaluated_poses",
        sa.Column("evaluation_id", ID, nullable=False),
        sa.Column("system", sa.Integer(), nullable=False),
        sa.Column("side", SHORT, nullable=False),
        sa.Column("ordinal", sa.Integer(), nullable=False),
        *_poses(),
        sa.Column("estimate_rows", sa.LargeBinary(), nullable=True),
        _of("evaluated_poses", "evaluation_id", "evaluations"),
        sa.PrimaryKeyConstraint("evaluation_id", "system", "side", "ordinal", name=op.f("pk_evaluated_poses")),
    )


def _make_live_evaluations() -> None:
    op.create_table(
        "live_evaluations",
        sa.Column("id", ID, nullable=False),
        sa.Column("site_id", ID, nullable=False),
        sa.Column("reference_id", ID, nullable=False),
        sa.Column("name", SHORT, nullable=False),
        sa.Column("options", sa.JSON(), nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.Column("closed_s", sa.Double(), nullable=True),
        *(
            sa.Column(name, sa.Integer(), nullable=False)
            for name in ("sample_count", "pair_count", "missed_count", "seen_ordinal")
        ),
        _of("live_evaluations", "site_id", "sites"),
        _of("live_evaluations", "reference_id", "trajectories"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_live_evaluations")),
    )
    for column in ("site_id", "reference_id"):
        op.create_index(op.f(f"ix_live_evaluations_{column}"), "live_evaluations", [column])
    op.create_table(
        "live_samples",
        sa.Column("id", ID, nullable=False),
        sa.Column("live_id", ID, nullable=False),
        *(sa.Column(name, sa.Double(), nullable=False) for name in ("time_s", "x_m", "y_m")),
        sa.Column("z_m", sa.Double(), nullable=True),
        sa.Column("floor", sa.Integer(), nullable=True),
        sa.Column("orientation_xyzw", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("state", SHORT, nullable=False),
        sa.Column("pair", sa.Integer(), nullable=True),
        *(sa.Column(name, sa.Double(), nullable=True) for name in ERRORS),
        sa.Column("right_floor", sa.Boolean(), nullable=True),
        _of("live_samples", "live_id", "live_evaluations"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_live_samples")),
        sa.UniqueConstraint("live_id", "time_s", name=op.f("uq_live_samples_live_id_time_s")),
        sa.UniqueConstraint("live_id", "pair", name=op.f("uq_live_samples_live_id_pair")),
    )
    op.create_index(op.f("ix_live_samples_live_id_state_time_s"), "live_samples", ["live_id", "state", "time_s"])


def _poses() -> list[sa.Column[Any]]:
    blobs = (("times_s", False), ("positions_m", False), ("orientations_xyzw", True), ("covariances", True))
    return [
        sa.Column("pose_count", sa.Integer(), nullable=False),
        *(sa.Column(name, sa.LargeBinary(), nullable=optional) for name, optional in (*blobs, ("floors", True))),
    ]


def _of(table: str, column: str, owner: str, when_deleted: str = "CASCADE") -> sa.ForeignKeyConstraint:
    return sa.ForeignKeyConstraint([column], [f"{owner}.id"], name=op.f(f"fk_{table}_{column}"), ondelete=when_deleted)


def downgrade() -> None:
    """Back; imported trajectories cannot be told from empty ones then, and go with their poses."""
    for table in (
        "live_samples",
        "live_evaluations",
        "evaluated_poses",
        "evaluated_systems",
        "evaluations",
        "imported_poses",
    ):
        op.drop_table(table)
    op.execute("DELETE FROM trajectories WHERE imported_count > 0")
    with op.batch_alter_table("trajectories") as batch_op:
        batch_op.drop_column("imported_count")
        batch_op.drop_column("source")
