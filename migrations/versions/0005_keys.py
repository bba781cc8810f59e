"""Keys, the sessions of browsers, and the record of who changed what."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

ID = sa.String(36)
SHORT = sa.String(200)
DIGEST = sa.String(64)


def upgrade() -> None:
    """Forward."""
    _create_keys()
    _create_sessions()
    _create_audit()


def _create_keys() -> None:
    op.create_table(
        "api_keys",
        sa.Column("id", ID, nullable=False),
        sa.Column("name", SHORT, nullable=False),
        sa.Column("digest", DIGEST, nullable=False),
        sa.Column("hint", SHORT, nullable=False),
        sa.Column("scopes", sa.JSON(), nullable=False),
        sa.Column("site_ids", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("rate_per_s", sa.Double(), nullable=True),
        sa.Column("burst", sa.Integer(), nullable=True),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.Column("expires_s", sa.Double(), nullable=True),
        sa.Column("revoked_s", sa.Double(), nullable=True),
        sa.Column("last_used_s", sa.Double(), nullable=True),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_api_keys")),
        sa.UniqueConstraint("digest", name=op.f("uq_api_keys_digest")),
    )


def _create_sessions() -> None:
    op.create_table(
        "browser_sessions",
        sa.Column("digest", DIGEST, nullable=False),
        sa.Column("key_id", ID, nullable=False),
        sa.Column("created_s", sa.Double(), nullable=False),
        sa.Column("expires_s", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(
            ["key_id"], ["api_keys.id"], name=op.f("fk_browser_sessions_key_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("digest", name=op.f("pk_browser_sessions")),
    )
    with op.batch_alter_table("browser_sessions") as batch_op:
        batch_op.create_index(batch_op.f("ix_browser_sessions_key_id"), ["key_id"])
        batch_op.create_index(batch_op.f("ix_browser_sessions_expires_s"), ["expires_s"])


def _create_audit() -> None:
    op.create_table(
        "audit",
        sa.Column("id", ID, nullable=False),
        sa.Column("at_s", sa.Double(), nullable=False),
        sa.Column("key_id", ID, nullable=True),
        sa.Column("name", SHORT, nullable=False),
        sa.Column("address", SHORT, nullable=False),
        sa.Column("request_id", SHORT, nullable=True),
        sa.Column("action", SHORT, nullable=False),
        sa.Column("site_id", SHORT, nullable=True),
        sa.Column("subject", sa.JSON(), nullable=False),
        sa.Column("outcome", SHORT, nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_audit")),
    )
    with op.batch_alter_table("audit") as batch_op:
        batch_op.create_index(batch_op.f("ix_audit_at_s"), ["at_s"])
        batch_op.create_index(batch_op.f("ix_audit_key_id_id"), ["key_id", "id"])
        batch_op.create_index(batch_op.f("ix_audit_site_id_id"), ["site_id", "id"])


def downgrade() -> None:
    """Back."""
    for table in ("audit", "browser_sessions", "api_keys"):
        op.drop_table(table)
