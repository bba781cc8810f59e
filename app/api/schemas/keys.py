"""Keys, sessions and the audit."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, Field

from app.api.schemas.common import WHOLE, Body, Finite, Listing, time_of
from app.api.schemas.texts import Text
from app.services.capture_time import seconds_of
from app.services.keys import GREATEST_SECRET_CHARACTERS, IssuedKey
from app.services.principal import Principal, Scope
from app.services.sessions import OpenedSession
from app.storage.audit import AuditEntry, Outcome
from app.storage.keys import ApiKey, NewKey
from app.storage.paging import Page

GREATEST_RATE_PER_S = 1_000_000
GREATEST_BURST = 1_000_000
GREATEST_SITES = 1000

Rate = Annotated[Finite, Field(gt=0, le=GREATEST_RATE_PER_S)]
Burst = Annotated[int, Field(ge=1, le=GREATEST_BURST, strict=True), WHOLE]
SiteIds = Annotated[list[Annotated[str, Field(max_length=100)]], Field(min_length=1, max_length=GREATEST_SITES)]
Moment = Annotated[str, Field(max_length=100, description="ISO 8601, UTC unless it names a zone, or epoch seconds.")]


class NewKeyBody(Body):
    """A key to be made."""

    name: Text
    scopes: Annotated[list[Scope], Field(min_length=1, max_length=4, description="admin includes the others.")]
    site_ids: SiteIds | None = Field(default=None, description="The only sites that there are for the key.")
    rate_per_s: Rate | None = Field(default=None, description="Requests a second; the installation's default if none.")
    burst: Burst | None = Field(default=None, description="How many requests may come at once.")
    expires_at: Moment | None = None

    def to_domain(self) -> NewKey:
        """The key as services know it."""
        return NewKey(
            name=self.name,
            scopes=tuple(self.scopes),
            site_ids=None if self.site_ids is None else tuple(self.site_ids),
            rate_per_s=self.rate_per_s,
            burst=self.burst,
            expires_s=None if self.expires_at is None else seconds_of(self.expires_at, "expires_at"),
        )


class KeyAnswer(BaseModel):
    """A key without its secret."""

    key_id: str
    name: str
    hint: str = Field(description="How the secret begins.")
    scopes: list[Scope]
    site_ids: list[str] | None = Field(description="null: all sites.")
    rate_per_s: float | None
    burst: int | None
    created_at: str
    expires_at: str | None
    revoked_at: str | None
    last_used_at: str | None = Field(description="Written once a minute at the most.")

    @classmethod
    def of(cls, key: ApiKey) -> KeyAnswer:
        """The answer for a key."""
        return cls(**_members(key))


class IssuedKeyAnswer(KeyAnswer):
    """A new key; its secret is told here and nowhere else."""

    secret: str

    @classmethod
    def of_issued(cls, issued: IssuedKey) -> IssuedKeyAnswer:
        """The answer for a new key."""
        return cls(**_members(issued.key), secret=issued.secret)


class KeysAnswer(Listing):
    """A page of keys."""

    keys: list[KeyAnswer]

    @classmethod
    def of(cls, page: Page[ApiKey]) -> KeysAnswer:
        """The answer for a page."""
        return cls(keys=[KeyAnswer.of(key) for key in page.items], next_cursor=page.next_cursor)


class ShownKeyBody(Body):
    """A key to be exchanged for a cookie."""

    key: Annotated[str, Field(min_length=1, max_length=GREATEST_SECRET_CHARACTERS)]


class PrincipalAnswer(BaseModel):
    """Who asks, and what they may do."""

    key_id: str | None = Field(description="null for those who need no key.")
    name: str
    scopes: list[Scope]
    site_ids: list[str] | None = Field(description="null: all sites.")

    @classmethod
    def of(cls, principal: Principal) -> PrincipalAnswer:
        """The answer for a principal."""
        return cls(**_members_of_principal(principal))


class SessionAnswer(PrincipalAnswer):
    """A session that was opened."""

    expires_at: str

    @classmethod
    def of_opened(cls, opened: OpenedSession) -> SessionAnswer:
        """The answer for a new session, without its secret, which is in the cookie alone."""
        return cls(**_members_of_principal(opened.principal), expires_at=time_of(opened.expires_s))


class AuditEntryAnswer(BaseModel):
    """Who changed what, or was refused to."""

    entry_id: str
    at: str
    key_id: str | None
    name: str
    address: str
    request_id: str | None
    action: str
    subject: dict[str, str] = Field(description="Ids of what was named and of what was made.")
    outcome: Outcome

    @classmethod
    def of(cls, entry: AuditEntry) -> AuditEntryAnswer:
        """The answer for an entry."""
        members = {**vars(entry.actor), **{name: getattr(entry, name) for name in ("entry_id", "action", "subject")}}
        return cls(**members, at=time_of(entry.at_s), outcome=entry.outcome)


class AuditAnswer(Listing):
    """A page of the audit, the newest first."""

    entries: list[AuditEntryAnswer]

    @classmethod
    def of(cls, page: Page[AuditEntry]) -> AuditAnswer:
        """The answer for a page."""
        return cls(entries=[AuditEntryAnswer.of(entry) for entry in page.items], next_cursor=page.next_cursor)


def _members(key: ApiKey) -> dict[str, Any]:
    grant = key.grant
    moments = {"expires_at": grant.expires_s, "revoked_at": key.revoked_s, "last_used_at": key.last_used_s}
    return {
        "key_id": key.key_id,
        "hint": key.hint,
        **{name: getattr(grant, name) for name in ("name", "scopes", "site_ids", "rate_per_s", "burst")},
        "created_at": time_of(key.created_s),
        **{name: None if moment_s is None else time_of(moment_s) for name, moment_s in moments.items()},
    }


def _members_of_principal(principal: Principal) -> dict[str, Any]:
    return {
        "key_id": principal.key_id,
        "name": principal.name,
        "scopes": sorted(principal.scopes),
        "site_ids": None if principal.site_ids is None else sorted(principal.site_ids),
    }
