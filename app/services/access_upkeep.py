"""What keys, sessions and the audit need now and then: uses are written, what is over is forgotten."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass

from app.errors import ScattermarkError
from app.services.key_ring import KeyRing
from app.storage.audit import AuditRepository
from app.storage.browser_sessions import BrowserSessionRepository
from app.storage.database import Database

log = logging.getLogger(__name__)

USES_WRITTEN_EVERY_S = 60.0
CLEANED_EVERY_S = 3600.0


@dataclass(frozen=True)
class AccessUpkeep:
    """The work of one process for its key ring.

    Attributes
    ----------
    audit_kept_s : float
        After this time an entry of the audit is removed.
    """

    database: Database
    ring: KeyRing
    audit_kept_s: float

    @contextlib.asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Do it now and then until the block ends, and once more then."""
        task = asyncio.create_task(self._run())
        try:
            yield
        finally:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task
            await self._once(clean=False)

    async def _run(self) -> None:
        cleaned_s = float("-inf")
        while True:
            due = time.monotonic() - cleaned_s >= CLEANED_EVERY_S
            await self._once(clean=due)
            cleaned_s = time.monotonic() if due else cleaned_s
            await asyncio.sleep(USES_WRITTEN_EVERY_S)

    async def _once(self, clean: bool) -> None:
        try:
            await asyncio.to_thread(self.ring.write_uses)
            if clean:
                await asyncio.to_thread(remove_what_is_over, self.database, self.audit_kept_s)
        except ScattermarkError as error:  # a database that is away comes back; requests say so meanwhile
            log.warning("uses of keys were not written: %s", error.detail)


def remove_what_is_over(database: Database, audit_kept_s: float) -> None:
    """Forget sessions that have ended and old entries of the audit."""
    now_s = time.time()
    with database.writing() as session:
        BrowserSessionRepository(session).remove_ended(now_s)
        AuditRepository(session).remove_before(now_s - audit_kept_s)
