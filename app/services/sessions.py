"""Sessions of browsers: a key is shown once, a cookie stands for it until a fixed time."""

from __future__ import annotations

import asyncio
import time
from dataclasses import dataclass
from datetime import UTC, datetime

from app.errors import NotAuthenticated
from app.services.key_ring import KeyRing
from app.services.keys import digest_of, new_secret, principal_of_key
from app.services.principal import Principal
from app.storage.audit import identify
from app.storage.browser_sessions import BrowserSession, BrowserSessionRepository
from app.storage.database import Database
from app.storage.keys import ApiKey

COOKIE_PREFIX = "sms_"


@dataclass(frozen=True)
class OpenedSession:
    """A session and the secret of its cookie."""

    secret: str
    principal: Principal
    expires_s: float

    @property
    def expires_at(self) -> datetime:
        """The same time as a date, UTC."""
        return datetime.fromtimestamp(self.expires_s, UTC)


class BrowserSessions:
    """Opens and closes sessions.

    Parameters
    ----------
    database : Database
    ring : KeyRing
    lasts_s : float
        From the showing of the key; being used does not lengthen it, so that a reading request writes nothing.
    """

    def __init__(self, database: Database, ring: KeyRing, lasts_s: float) -> None:
        self._database = database
        self._ring = ring
        self._lasts_s = lasts_s

    async def open(self, key_secret: str) -> OpenedSession:
        """A session for whoever shows a key.

        Raises
        ------
        NotAuthenticated
        """
        holder = await self._ring.holder_of_key(key_secret)
        if holder is None:
            raise NotAuthenticated("this key is unknown, expired or revoked; ask the operator for another one")
        return await asyncio.to_thread(self._open, holder.key)

    async def close(self, cookie: str | None) -> None:
        """End a session; nothing happens when there is none, or when it has ended."""
        if cookie is None:
            return
        await asyncio.to_thread(self._close, cookie)
        self._ring.forget_cookie(cookie)

    def _open(self, key: ApiKey) -> OpenedSession:
        identify(key.key_id, key.grant.name)
        secret = new_secret(COOKIE_PREFIX)
        ends_s = [time.time() + self._lasts_s, *([] if key.grant.expires_s is None else [key.grant.expires_s])]
        with self._database.writing() as session:
            BrowserSessionRepository(session).add(digest_of(secret), BrowserSession(key, min(ends_s)))
        return OpenedSession(secret, principal_of_key(key), min(ends_s))

    def _close(self, cookie: str) -> None:
        digest = digest_of(cookie)
        with self._database.reading() as session:
            found = BrowserSessionRepository(session).find(digest)
        if found is not None:  # else whoever has no session could fill the audit
            identify(found.key.key_id, found.key.grant.name)
            with self._database.writing() as session:
                BrowserSessionRepository(session).remove(digest)
