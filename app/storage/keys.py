"""Keys in the database: the digest of the secret, what the key may do, when it was used last."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import ColumnElement, delete, or_, select, update
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.ids import new_id
from app.storage.models import BrowserSessionRow, KeyRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.upsert import insert_if_absent


@dataclass(frozen=True)
class NewKey:
    """What a key shall be.

    Attributes
    ----------
    site_ids : tuple of str or None
        The only sites that there are for it; None for all.
    rate_per_s, burst : float, int or None
        Requests a second in the long run, and how many may come at once; None for the installation's default.
    expires_s : float or None
        UTC, seconds since 1970, as all times here.
    """

    name: str
    scopes: tuple[str, ...]
    site_ids: tuple[str, ...] | None = None
    rate_per_s: float | None = None
    burst: int | None = None
    expires_s: float | None = None


@dataclass(frozen=True)
class Fingerprint:
    """What is kept of a secret: its SHA-256, and the few characters by which people tell keys apart."""

    digest: str
    hint: str


@dataclass(frozen=True)
class ApiKey:
    """A key without its secret."""

    key_id: str
    grant: NewKey
    hint: str
    created_s: float
    revoked_s: float | None
    last_used_s: float | None

    def valid_at(self, now_s: float) -> bool:
        """Whether the key opens anything at this time."""
        return self.revoked_s is None and (self.grant.expires_s is None or now_s < self.grant.expires_s)


class KeyRepository:
    """Keys of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, new: NewKey, fingerprint: Fingerprint) -> ApiKey:
        """A new key."""
        row = KeyRow(**_values(new, fingerprint))
        self._session.add(row)
        self._session.flush()
        return key_of_row(row)

    def add_once(self, new: NewKey, fingerprint: Fingerprint) -> bool:
        """A new key, unless one with this secret is there already, which may be revoked."""
        return insert_if_absent(self._session, KeyRow, **_values(new, fingerprint))

    def get(self, key_id: str) -> ApiKey:
        """One key.

        Raises
        ------
        NotFound
        """
        return key_of_row(self._row(key_id))

    def find(self, digest: str) -> ApiKey | None:
        """The key whose secret has this digest."""
        row = self._session.scalar(select(KeyRow).where(KeyRow.digest == digest))
        return None if row is None else key_of_row(row)

    def page(self, request: PageRequest) -> Page[ApiKey]:
        """Keys in the order they were made, those that open nothing any more included."""
        query = select(KeyRow).order_by(KeyRow.id).limit(request.limit + 1)
        if request.after is not None:
            query = query.where(KeyRow.id > request.after)
        return page_of([(row.id, key_of_row(row)) for row in self._session.scalars(query)], request.limit)

    def revoke(self, key_id: str) -> ApiKey:
        """Let a key open nothing from now on, and end the sessions that it opened; a second time changes nothing.

        Raises
        ------
        NotFound
        """
        row = self._row(key_id)
        row.revoked_s = row.revoked_s or time.time()
        self._session.execute(delete(BrowserSessionRow).where(BrowserSessionRow.key_id == key_id))
        self._session.flush()
        return key_of_row(row)

    def any_valid(self, now_s: float) -> bool:
        """Whether there is a key that opens anything."""
        return self._session.scalar(select(KeyRow.id).where(*_valid(now_s)).limit(1)) is not None

    def any_administrator(self) -> bool:
        """Whether there ever was a key with the scope ``admin``: revoked ones count."""
        return any("admin" in scopes for scopes in self._session.scalars(select(KeyRow.scopes)))

    def note_use(self, used_s: Mapping[str, float]) -> None:
        """When keys were used last, by their ids; a later time that is there already stays."""
        for key_id, when_s in sorted(used_s.items()):
            earlier = or_(KeyRow.last_used_s.is_(None), KeyRow.last_used_s < when_s)
            self._session.execute(update(KeyRow).where(KeyRow.id == key_id, earlier).values(last_used_s=when_s))

    def _row(self, key_id: str) -> KeyRow:
        row = self._session.get(KeyRow, key_id)
        if row is None:
            raise NotFound(f"there is no key {key_id}; GET /keys lists them", key_id=key_id)
        return row


def _valid(now_s: float) -> tuple[ColumnElement[bool], ...]:
    return KeyRow.revoked_s.is_(None), or_(KeyRow.expires_s.is_(None), KeyRow.expires_s > now_s)


def _values(new: NewKey, fingerprint: Fingerprint) -> dict[str, object]:
    return {
        "id": new_id(),
        "name": new.name,
        "digest": fingerprint.digest,
        "hint": fingerprint.hint,
        "scopes": list(new.scopes),
        "site_ids": None if new.site_ids is None else list(new.site_ids),
        "rate_per_s": new.rate_per_s,
        "burst": new.burst,
        "created_s": time.time(),
        "expires_s": new.expires_s,
        "revoked_s": None,
        "last_used_s": None,
    }


def key_of_row(row: KeyRow) -> ApiKey:
    """The key that a row holds."""
    grant = NewKey(
        name=row.name,
        scopes=tuple(row.scopes),
        site_ids=None if row.site_ids is None else tuple(row.site_ids),
        rate_per_s=row.rate_per_s,
        burst=row.burst,
        expires_s=row.expires_s,
    )
    return ApiKey(row.id, grant, row.hint, row.created_s, row.revoked_s, row.last_used_s)
