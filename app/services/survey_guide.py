"""Guidance while a survey is photographed: what comes in is detected in the background, once, as a build would.

From the first time that somebody asks for a survey's guidance its photographs are detected as they come, one after the
other, so that snapshots keep the other workers. What was detected lies where a build looks for it.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from typing import Self

from app.errors import ScattermarkError
from app.photogrammetry.survey_guidance import Guidance
from app.services.build_options import BuildOptions
from app.services.detect_work import DetectSettings, DetectTask, detect_photo
from app.services.guide_work import GuideTask, guide
from app.services.ports import CpuPool
from app.storage.database import Database
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.vision.photo import PhotoLimits

log = logging.getLogger(__name__)

MOST_WAITING = 10_000  # photographs; who sends more is told of the rest when asking for guidance
GUIDED_S = 3600.0  # so long after it was asked for, photographs of a survey are still detected as they come
MOST_UNREADABLE = 10_000  # digests of photographs that no detector can read, remembered so that none is tried for ever


@dataclass(frozen=True)
class GuideLimits:
    """What a photograph may be, and how long its detection and a survey's network may take."""

    photo: PhotoLimits
    detect_timeout_s: float
    network_timeout_s: float


@dataclass(frozen=True)
class SurveyGuidance:
    """Guidance, and how many photographs still wait to be looked at; names of those that cannot be used."""

    guidance: Guidance
    pending: int
    unusable: tuple[str, ...]


@dataclass(frozen=True)
class _Inventory:
    """A survey's photographs: how they are read, which were not yet, and names by digest."""

    settings: DetectSettings
    missing: tuple[str, ...]
    names: dict[str, str]


class SurveyGuide:
    """Detects in the background and says what surveys lack; on one event loop."""

    def __init__(self, database: Database, pool: CpuPool, limits: GuideLimits) -> None:
        self._database = database
        self._pool = pool
        self._limits = limits
        self._waiting: asyncio.Queue[DetectTask] = asyncio.Queue(MOST_WAITING)
        self._queued: set[tuple[str, str]] = set()
        self._unreadable: dict[tuple[str, str], str] = {}
        self._asked_s: dict[str, float] = {}

    @asynccontextmanager
    async def running(self) -> AsyncIterator[Self]:
        """Detect what comes until the block ends; what then waits is detected by a build."""
        work = asyncio.create_task(self._work())
        try:
            yield self
        finally:
            work.cancel()
            with suppress(asyncio.CancelledError):
                await work

    async def notice(self, survey_id: str) -> None:
        """Have what is new in a survey looked at, if somebody asks for its guidance these days."""
        asked_s = self._asked_s.get(survey_id)
        if asked_s is None or time.monotonic() - asked_s > GUIDED_S:
            self._asked_s.pop(survey_id, None)
            return
        self._enqueue(await asyncio.to_thread(self._inventory, survey_id))

    async def guidance(self, survey_id: str) -> SurveyGuidance:
        """What a survey lacks, by the photographs that were looked at so far; the others are looked at now.

        Raises
        ------
        NotFound
            When there is no such survey.
        ServerFull, TimedOut, WorkerCrashed
            When the network could not be computed.
        """
        inventory = await asyncio.to_thread(self._inventory, survey_id)
        self._asked_s[survey_id] = time.monotonic()
        self._enqueue(inventory)
        task = GuideTask(survey_id, inventory.settings)
        guidance: Guidance = await self._pool.run(guide, task, timeout_s=self._limits.network_timeout_s)
        unusable = [sha256 for sha256 in inventory.missing if self._key(inventory.settings, sha256) in self._unreadable]
        names = tuple(sorted(inventory.names[sha256] for sha256 in unusable))
        return SurveyGuidance(guidance, len(inventory.missing) - len(unusable), names)

    def _inventory(self, survey_id: str) -> _Inventory:
        with self._database.reading() as session:
            survey = SurveyRepository(session).get(survey_id)
            family = SiteRepository(session).get(survey.site_id).code_family
            settings = DetectSettings.of(family, BuildOptions())
            photos = SurveyRepository(session).photos(survey_id)
            missing = DetectionRepository(session).missing(settings.key(photo.sha256) for photo in photos)
        return _Inventory(
            settings, tuple(key.sha256 for key in missing), {photo.sha256: photo.name for photo in photos}
        )

    def _enqueue(self, inventory: _Inventory) -> None:
        for sha256 in inventory.missing:
            key = self._key(inventory.settings, sha256)
            if key in self._queued or key in self._unreadable or self._waiting.full():
                continue
            self._queued.add(key)
            self._waiting.put_nowait(DetectTask(sha256, inventory.settings, self._limits.photo))

    async def _work(self) -> None:
        while True:
            task = await self._waiting.get()
            key = self._key(task.settings, task.sha256)
            try:
                reason = await self._pool.run(detect_photo, task, timeout_s=self._limits.detect_timeout_s)
                if reason is not None:
                    self._remember(key, reason)
            except ScattermarkError as error:
                # Whoever asks for guidance next has it tried again.
                log.warning("photograph %s could not be looked at: %s", task.sha256, error.detail)
            except Exception:  # a fault of ours must not end all guidance
                log.exception("photograph %s could not be looked at by a fault", task.sha256)
            finally:
                self._queued.discard(key)

    def _remember(self, key: tuple[str, str], reason: str) -> None:
        log.info("photograph %s cannot be used: %s", key[0], reason)
        self._unreadable[key] = reason
        while len(self._unreadable) > MOST_UNREADABLE:
            del self._unreadable[next(iter(self._unreadable))]

    @staticmethod
    def _key(settings: DetectSettings, sha256: str) -> tuple[str, str]:
        return sha256, settings.code_family
