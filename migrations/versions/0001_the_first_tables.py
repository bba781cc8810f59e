"""The first tables."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Forward."""

    op.create_table(
        "detections",
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("detector", sa.String(length=200), nullable=False),
        sa.Column("options_digest", sa.String(length=64), nullable=False),
        sa.Column("record", sa.LargeBinary(), nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.PrimaryKeyConstraint("sha256", "detector", "options_digest", name=op.f("pk_detections")),
    )
    op.create_table(
        "sites",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("code_family", sa.String(length=200), nullable=False),
        sa.Column("plate_u_m", sa.Double(), nullable=False),
        sa.Column("geo_anchor", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("active_version", sa.Integer(), nullable=True),
        sa.Column("last_version", sa.Integer(), nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_sites")),
    )
    op.create_table(
        "cameras",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=True),
        sa.Column("map_version", sa.Integer(), nullable=True),
        sa.Column("device_id", sa.String(length=200), nullable=True),
        sa.Column("source", sa.String(length=200), nullable=False),
        sa.Column("identity", sa.JSON(), nullable=False),
        sa.Column("intrinsics", sa.LargeBinary(), nullable=False),
        sa.Column("covariance", sa.LargeBinary(), nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_cameras_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_cameras")),
    )
    with op.batch_alter_table("cameras", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_cameras_device_id_created_s"), ["device_id", "created_s"], unique=False)
        batch_op.create_index(batch_op.f("ix_cameras_site_id_created_s"), ["site_id", "created_s"], unique=False)

    op.create_table(
        "control_points",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("ordinal", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("code", sa.Integer(), nullable=False),
        sa.Column("dot", sa.String(length=200), nullable=False),
        sa.Column("x_m", sa.Double(), nullable=False),
        sa.Column("y_m", sa.Double(), nullable=False),
        sa.Column("z_m", sa.Double(), nullable=False),
        sa.Column("sigma_m", sa.Double(), nullable=False),
        sa.Column("role", sa.String(length=200), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_control_points_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_control_points")),
        sa.UniqueConstraint("site_id", "code", "dot", name=op.f("uq_control_points_site_id_code_dot")),
        sa.UniqueConstraint("site_id", "name", name=op.f("uq_control_points_site_id_name")),
    )
    with op.batch_alter_table("control_points", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_control_points_site_id"), ["site_id"], unique=False)

    op.create_table(
        "surveys",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("note", sa.Text(), nullable=False),
        sa.Column("device_id", sa.String(length=200), nullable=True),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_surveys_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_surveys")),
    )
    with op.batch_alter_table("surveys", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_surveys_site_id"), ["site_id"], unique=False)

    op.create_table(
        "trajectories",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("device_id", sa.String(length=200), nullable=True),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("default_key", sa.Text(), nullable=True),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.Column("closed_s", sa.Double(), nullable=True),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_trajectories_site_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_trajectories")),
        sa.UniqueConstraint("default_key", name=op.f("uq_trajectories_default_key")),
    )
    with op.batch_alter_table("trajectories", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_trajectories_site_id"), ["site_id"], unique=False)

    op.create_table(
        "jobs",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("kind", sa.String(length=200), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("survey_id", sa.String(length=36), nullable=False),
        sa.Column("options", sa.JSON(), nullable=False),
        sa.Column("state", sa.String(length=200), nullable=False),
        sa.Column("stage", sa.String(length=200), nullable=False),
        sa.Column("done", sa.Integer(), nullable=False),
        sa.Column("total", sa.Integer(), nullable=False),
        sa.Column("error", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("result", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("owner", sa.String(length=200), nullable=True),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.Column("started_s", sa.Double(), nullable=True),
        sa.Column("finished_s", sa.Double(), nullable=True),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_jobs_site_id"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["survey_id"], ["surveys.id"], name=op.f("fk_jobs_survey_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_jobs")),
    )
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_jobs_site_id"), ["site_id"], unique=False)
        batch_op.create_index(batch_op.f("ix_jobs_state"), ["state"], unique=False)
        batch_op.create_index(batch_op.f("ix_jobs_survey_id"), ["survey_id"], unique=False)

    op.create_table(
        "photographs",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("survey_id", sa.String(length=36), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("size_bytes", sa.BigInteger(), nullable=False),
        sa.Column("identity", sa.JSON(), nullable=False),
        sa.Column("captured_at", sa.String(length=200), nullable=True),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(
            ["survey_id"], ["surveys.id"], name=op.f("fk_photographs_survey_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_photographs")),
        sa.UniqueConstraint("survey_id", "name", name=op.f("uq_photographs_survey_id_name")),
    )
    with op.batch_alter_table("photographs", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_photographs_sha256"), ["sha256"], unique=False)
        batch_op.create_index(batch_op.f("ix_photographs_survey_id"), ["survey_id"], unique=False)

    op.create_table(
        "snapshots",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("trajectory_id", sa.String(length=36), nullable=False),
        sa.Column("snapshot_id", sa.String(length=36), nullable=True),
        sa.Column("device_id", sa.String(length=200), nullable=True),
        sa.Column("map_version", sa.Integer(), nullable=False),
        sa.Column("captured_s", sa.Double(), nullable=False),
        sa.Column("received_s", sa.Double(), nullable=False),
        sa.Column("time_source", sa.String(length=200), nullable=False),
        sa.Column("clock_delay_s", sa.Double(), nullable=True),
        sa.Column("reason", sa.String(length=200), nullable=True),
        sa.Column("x_m", sa.Double(), nullable=True),
        sa.Column("y_m", sa.Double(), nullable=True),
        sa.Column("z_m", sa.Double(), nullable=True),
        sa.Column("sigma_m", sa.Double(), nullable=True),
        sa.Column("rotation", sa.LargeBinary(), nullable=True),
        sa.Column("covariance", sa.LargeBinary(), nullable=True),
        sa.Column("seen", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_snapshots_site_id"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(
            ["trajectory_id"], ["trajectories.id"], name=op.f("fk_snapshots_trajectory_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_snapshots")),
        sa.UniqueConstraint("site_id", "snapshot_id", name=op.f("uq_snapshots_site_id_snapshot_id")),
    )
    with op.batch_alter_table("snapshots", schema=None) as batch_op:
        batch_op.create_index(
            batch_op.f("ix_snapshots_trajectory_id_captured_s"), ["trajectory_id", "captured_s"], unique=False
        )

    op.create_table(
        "target_maps",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("site_id", sa.String(length=36), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("survey_id", sa.String(length=36), nullable=True),
        sa.Column("job_id", sa.String(length=36), nullable=True),
        sa.Column("base_version", sa.Integer(), nullable=True),
        sa.Column("code_family", sa.String(length=200), nullable=False),
        sa.Column("u_m", sa.Double(), nullable=False),
        sa.Column("target_count", sa.Integer(), nullable=False),
        sa.Column("datum_origin", sa.LargeBinary(), nullable=False),
        sa.Column("datum_covariance", sa.LargeBinary(), nullable=False),
        sa.Column("assumed_scale", sa.Boolean(), nullable=False),
        sa.Column("assumed_orientation", sa.Boolean(), nullable=False),
        sa.Column("report", sa.JSON(), nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(["site_id"], ["sites.id"], name=op.f("fk_target_maps_site_id"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(
            ["survey_id"], ["surveys.id"], name=op.f("fk_target_maps_survey_id"), ondelete="SET NULL"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_target_maps")),
        sa.UniqueConstraint("job_id", name=op.f("uq_target_maps_job_id")),
        sa.UniqueConstraint("site_id", "version", name=op.f("uq_target_maps_site_id_version")),
    )
    with op.batch_alter_table("target_maps", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_target_maps_site_id"), ["site_id"], unique=False)

    op.create_table(
        "map_photos",
        sa.Column("map_id", sa.String(length=36), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("camera_key", sa.Text(), nullable=True),
        sa.Column("rotation", sa.LargeBinary(), nullable=True),
        sa.Column("position_m", sa.LargeBinary(), nullable=True),
        sa.Column("covariance", sa.LargeBinary(), nullable=True),
        sa.Column("rms_px", sa.Double(), nullable=True),
        sa.Column("target_count", sa.Integer(), nullable=True),
        sa.Column("reason", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(["map_id"], ["target_maps.id"], name=op.f("fk_map_photos_map_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("map_id", "name", name=op.f("pk_map_photos")),
    )
    op.create_table(
        "mapped_targets",
        sa.Column("map_id", sa.String(length=36), nullable=False),
        sa.Column("code", sa.Integer(), nullable=False),
        sa.Column("rotation", sa.LargeBinary(), nullable=False),
        sa.Column("position_m", sa.LargeBinary(), nullable=False),
        sa.Column("dots_m", sa.LargeBinary(), nullable=False),
        sa.Column("covariance", sa.LargeBinary(), nullable=False),
        sa.Column("rays", sa.Integer(), nullable=False),
        sa.Column("rms_px", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(
            ["map_id"], ["target_maps.id"], name=op.f("fk_mapped_targets_map_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("map_id", "code", name=op.f("pk_mapped_targets")),
    )


def downgrade() -> None:
    """Back."""

    op.drop_table("mapped_targets")
    op.drop_table("map_photos")
    with op.batch_alter_table("target_maps", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_target_maps_site_id"))

    op.drop_table("target_maps")
    with op.batch_alter_table("snapshots", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_snapshots_trajectory_id_captured_s"))

    op.drop_table("snapshots")
    with op.batch_alter_table("photographs", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_photographs_survey_id"))
        batch_op.drop_index(batch_op.f("ix_photographs_sha256"))

    op.drop_table("photographs")
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_jobs_survey_id"))
        batch_op.drop_index(batch_op.f("ix_jobs_state"))
        batch_op.drop_index(batch_op.f("ix_jobs_site_id"))

    op.drop_table("jobs")
    with op.batch_alter_table("trajectories", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_trajectories_site_id"))

    op.drop_table("trajectories")
    with op.batch_alter_table("surveys", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_surveys_site_id"))

    op.drop_table("surveys")
    with op.batch_alter_table("control_points", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_control_points_site_id"))

    op.drop_table("control_points")
    with op.batch_alter_table("cameras", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_cameras_site_id_created_s"))
        batch_op.drop_index(batch_op.f("ix_cameras_device_id_created_s"))

    op.drop_table("cameras")
    op.drop_table("sites")
    op.drop_table("detections")
