"""Alerts of a site: looked for when somebody asks and snapshots have come since, and by workers every ten minutes."""

from __future__ import annotations

import asyncio
import time
from collections import defaultdict
from contextlib import suppress
from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import NotFound
from app.photogrammetry.map_watch import WatchOptions
from app.services.alert_work import SNAPSHOTS_KEPT, WatchTask, settle_alerts, watch_site
from app.services.ports import CpuPool
from app.storage.alerts import Alert, AlertFilter, AlertRepository
from app.storage.database import Database
from app.storage.map_evidence import EvidenceRepository, EvidenceState
from app.storage.paging import Page, PageRequest
from app.storage.sites import SiteRepository


@dataclass(frozen=True)
class _Seen:
    """Up to where the evidence of a site was looked at."""

    map_version: int
    state: EvidenceState


@dataclass(frozen=True)
class WatchedAlerts:
    """A page of alerts, and what they rest on.

    Attributes
    ----------
    page : Page of Alert
    map_version : int or None
        The active one.
    snapshots : int
        That were held against it.
    """

    page: Page[Alert]
    map_version: int | None
    snapshots: int


class MapWatch:
    """Tells a site's alerts, never older than its newest snapshot.

    Parameters
    ----------
    database : Database
    pool : CpuPool
        Whose workers have a workbench.
    timeout_s : float
        Of one look at a site.
    """

    def __init__(self, database: Database, pool: CpuPool, timeout_s: float) -> None:
        self._database = database
        self._pool = pool
        self._timeout_s = timeout_s
        self._seen: dict[str, _Seen] = {}
        self._looking: defaultdict[str, asyncio.Lock] = defaultdict(asyncio.Lock)

    async def page(self, wanted: AlertFilter, request: PageRequest) -> WatchedAlerts:
        """Alerts of a site, the newest first.

        Raises
        ------
        NotFound
            When there is no such site.
        ServerFull, TimedOut, WorkerCrashed
            When what came since could not be looked at.
        """
        if not await self._is_known(wanted.site_id):
            async with self._looking[wanted.site_id]:  # who comes second finds it done
                await self._look(wanted.site_id)
        return await asyncio.to_thread(self._read, wanted, request)

    async def _is_known(self, site_id: str) -> bool:
        """Whether all that the snapshots tell was looked at."""
        present = await asyncio.to_thread(_present, self._database, site_id)
        return present is None or self._seen.get(site_id) == present

    async def _look(self, site_id: str) -> None:
        """See what the snapshots tell."""
        present = await asyncio.to_thread(_present, self._database, site_id)
        if present is None or self._seen.get(site_id) == present:
            return
        await self._pool.run(watch_site, WatchTask(site_id, present.map_version), timeout_s=self._timeout_s)
        self._seen[site_id] = present

    def _read(self, wanted: AlertFilter, request: PageRequest) -> WatchedAlerts:
        with self._database.reading() as session:
            page = AlertRepository(session).page(wanted, request)
            version = SiteRepository(session).get(wanted.site_id).active_version
            watched = 0 if version is None else EvidenceRepository(session).state(wanted.site_id, version).count
            return WatchedAlerts(page, version, watched)


class WatchRound:
    """A worker's round over all sites: alerts are settled, evidence that no look takes any more is forgotten."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._seen: dict[str, _Seen] = {}

    def __call__(self) -> str:
        """Do it; what was done, in words."""
        with self._database.reading() as session:
            maps = EvidenceRepository(session).watched_maps()
        looked = 0
        for site_id in sorted({site_id for site_id, _ in maps}):
            with suppress(NotFound):  # removed meanwhile
                looked += self._look(site_id)
        forgotten = sum(self._forget(site_id, version) for site_id, version in maps)
        return f"{looked} maps looked at, {forgotten} old pieces of evidence forgotten"

    def _look(self, site_id: str) -> bool:
        present = _present(self._database, site_id)
        if present is None or self._seen.get(site_id) == present:
            return False
        settle_alerts(self._database, WatchTask(site_id, present.map_version), WatchOptions())
        self._seen[site_id] = present
        return True

    def _forget(self, site_id: str, map_version: int) -> int:
        with self._database.writing() as session:
            return EvidenceRepository(session).forget_older(site_id, map_version, SNAPSHOTS_KEPT)


def acknowledge(session: Session, alert_id: str, note: str) -> Alert:
    """Say that an alert is known; it stays until the trouble is over.

    Raises
    ------
    NotFound
    """
    return AlertRepository(session).acknowledge(alert_id, note, time.time())


def _present(database: Database, site_id: str) -> _Seen | None:
    """The active map of a site and what tells of it; None without a map.

    Raises
    ------
    NotFound
        When there is no such site.
    """
    with database.reading() as session:
        version = SiteRepository(session).get(site_id).active_version
        return None if version is None else _Seen(version, EvidenceRepository(session).state(site_id, version))
