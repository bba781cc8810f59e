"""Keys, the sessions of browsers, and the record of who changed what."""

from __future__ import annotations

from sqlalchemy import JSON, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from app.storage.models.base import Base, Digest, Id, Json, JsonList, Number, Short


class KeyRow(Base):
    """A key; of its secret only the digest is kept, and the few characters by which people tell keys apart."""

    __tablename__ = "api_keys"
    id: Mapped[Id]
    name: Mapped[Short]
    digest: Mapped[Digest] = mapped_column(unique=True)
    hint: Mapped[Short]
    scopes: Mapped[JsonList]
    site_ids: Mapped[JsonList | None] = mapped_column(JSON(none_as_null=True))  # null: all sites
    rate_per_s: Mapped[Number | None]
    burst: Mapped[int | None]
    created_s: Mapped[Number]
    expires_s: Mapped[Number | None]
    revoked_s: Mapped[Number | None]
    last_used_s: Mapped[Number | None]


class BrowserSessionRow(Base):
    """A browser that showed a key; known by the digest of its cookie."""

    __tablename__ = "browser_sessions"
    digest: Mapped[Digest] = mapped_column(primary_key=True)
    key_id: Mapped[str] = mapped_column(String(36), ForeignKey("api_keys.id", ondelete="CASCADE"), index=True)
    created_s: Mapped[Number]
    expires_s: Mapped[Number] = mapped_column(index=True)


class AuditRow(Base):
    """Who changed what and when. It refers to nothing, so that it outlives what it tells of."""

    __tablename__ = "audit"
    __table_args__ = (Index(None, "key_id", "id"), Index(None, "site_id", "id"))
    id: Mapped[Id]
    at_s: Mapped[Number] = mapped_column(index=True)
    key_id: Mapped[str | None] = mapped_column(String(36))
    name: Mapped[Short]
    address: Mapped[Short]
    request_id: Mapped[Short | None]
    action: Mapped[Short]
    site_id: Mapped[Short | None]
    subject: Mapped[Json]
    outcome: Mapped[Short]
