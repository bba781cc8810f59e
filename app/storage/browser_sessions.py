"""Sessions of browsers in the database: a cookie's digest stands for the key that opened it, for a while."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from app.storage.keys import ApiKey, key_of_row
from app.storage.models import BrowserSessionRow, KeyRow


@dataclass(frozen=True)
class BrowserSession:
    """A browser that showed a key; it ends with the key at the latest."""

    key: ApiKey
    expires_s: float

    def __post_init__(self) -> None:
        if self.key.grant.expires_s is not None and self.expires_s > self.key.grant.expires_s:
            raise ValueError("a session ends with its key at the latest")

    def key_until_then(self) -> ApiKey:
        """The key, valid no longer than the session."""
        return replace(self.key, grant=replace(self.key.grant, expires_s=self.expires_s))


class BrowserSessionRepository:
    """Browsers' sessions of one database session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, digest: str, opened: BrowserSession) -> None:
        """Keep a session that was opened now."""
        row = BrowserSessionRow(
            digest=digest, key_id=opened.key.key_id, created_s=time.time(), expires_s=opened.expires_s
        )
        self._session.add(row)
        self._session.flush()

    def find(self, digest: str) -> BrowserSession | None:
        """The session whose cookie has this digest, whether or not its time is over."""
        query = select(BrowserSessionRow, KeyRow).join(KeyRow).where(BrowserSessionRow.digest == digest)
        found = self._session.execute(query).first()
        return None if found is None else BrowserSession(key_of_row(found[1]), found[0].expires_s)

    def remove(self, digest: str) -> None:
        """End a session; nothing happens when it has ended."""
        self._session.execute(delete(BrowserSessionRow).where(BrowserSessionRow.digest == digest))

    def remove_ended(self, now_s: float) -> None:
        """Forget the sessions whose time is over."""
        self._session.execute(delete(BrowserSessionRow).where(BrowserSessionRow.expires_s <= now_s))
