"""Keys that were shown lately: looked up once, then known for a few seconds."""

from __future__ import annotations

import asyncio
import time
from collections import OrderedDict
from dataclasses import dataclass
from typing import Literal

from app.services.keys import GREATEST_SECRET_CHARACTERS, digest_of, principal_of_key, rate_of_key
from app.services.principal import Principal
from app.services.rates import Rate
from app.storage.browser_sessions import BrowserSessionRepository
from app.storage.database import Database
from app.storage.keys import ApiKey, KeyRepository

KNOWN_S = 5.0  # another process's revocation is honoured within this time
REMEMBERED = 10_000  # secrets, wrong ones included: a flood of them neither fills memory nor reaches the database twice

Kind = Literal["key", "cookie"]  # one is never taken for the other


@dataclass(frozen=True)
class Holder:
    """Whoever shows a key: who they are and how often they may ask."""

    key: ApiKey
    principal: Principal
    rate: Rate


@dataclass(frozen=True)
class _Known:
    holder: Holder | None
    looked_up_s: float


class KeyRing:
    """Finds the holders of keys and of cookies; used from one event loop.

    Parameters
    ----------
    database : Database
    default_rate : Rate
        Of keys that name none.
    """

    def __init__(self, database: Database, default_rate: Rate) -> None:
        self._database = database
        self._default_rate = default_rate
        self._known: OrderedDict[tuple[Kind, str], _Known] = OrderedDict()
        self._used_s: dict[str, float] = {}

    async def holder_of_key(self, secret: str) -> Holder | None:
        """Whoever holds this key; None when it opens nothing."""
        return await self._find("key", secret)

    async def holder_of_cookie(self, secret: str) -> Holder | None:
        """Whoever holds the key that opened this session; None when it has ended."""
        return await self._find("cookie", secret)

    def forget(self, key_id: str) -> None:
        """Look a key and its sessions up again at once, as it was revoked."""
        stale = [shown for shown, known in self._known.items() if known.holder and known.holder.key.key_id == key_id]
        for shown in stale:
            del self._known[shown]

    def forget_cookie(self, secret: str) -> None:
        """Look a cookie up again at once, as its session has ended."""
        self._known.pop(("cookie", digest_of(secret)), None)

    def write_uses(self) -> None:
        """Keep when keys were used last; called seldom, from a thread."""
        used_s, self._used_s = self._used_s, {}
        if used_s:
            with self._database.writing() as session:
                KeyRepository(session).note_use(used_s)

    async def _find(self, kind: Kind, secret: str) -> Holder | None:
        if len(secret) > GREATEST_SECRET_CHARACTERS:
            return None
        shown = kind, digest_of(secret)
        known = self._known.get(shown)
        if known is None or time.monotonic() - known.looked_up_s > KNOWN_S:
            known = await self._look_up(shown)
        now_s = time.time()
        if known.holder is None or not known.holder.key.valid_at(now_s):
            return None
        self._used_s[known.holder.key.key_id] = now_s
        return known.holder

    async def _look_up(self, shown: tuple[Kind, str]) -> _Known:
        kind, digest = shown
        asked_s = time.monotonic()
        key = await asyncio.to_thread(self._key_of if kind == "key" else self._key_of_cookie, digest)
        known = _Known(None if key is None else self._holder(key), asked_s)
        self._known[shown] = known
        self._known.move_to_end(shown)
        if len(self._known) > REMEMBERED:
            self._known.popitem(last=False)
        return known

    def _holder(self, key: ApiKey) -> Holder:
        return Holder(key, principal_of_key(key), rate_of_key(key, self._default_rate))

    def _key_of(self, digest: str) -> ApiKey | None:
        with self._database.reading() as session:
            return KeyRepository(session).find(digest)

    def _key_of_cookie(self, digest: str) -> ApiKey | None:
        with self._database.reading() as session:
            found = BrowserSessionRepository(session).find(digest)
        return None if found is None else found.key_until_then()
