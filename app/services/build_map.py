"""The story of a survey: photographs -> detect each -> adjust -> publish the target map."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from app.errors import TimedOut, WorkerCrashed
from app.services.adjust_work import AdjustTask, Unreadable, adjust_and_publish
from app.services.build_options import BuildOptions
from app.services.detect_work import DetectSettings, DetectTask, detect_photo
from app.services.job_progress import JobProgress
from app.services.ports import CpuPool
from app.storage.database import Database
from app.storage.jobs import Job
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.vision.photo import PhotoLimits


@dataclass(frozen=True)
class BuildLimits:
    """How wide and how long a build may be.

    Attributes
    ----------
    photo : PhotoLimits
    width : int
        Photographs that are detected at a time.
    detect_timeout_s, adjust_timeout_s : float
        Of one photograph and of the adjustment.
    """

    photo: PhotoLimits
    width: int
    detect_timeout_s: float
    adjust_timeout_s: float


@dataclass(frozen=True)
class _Plan:
    """Digests of the survey's photographs, and those among them that were never detected with these settings."""

    settings: DetectSettings
    photos: tuple[tuple[str, str], ...]  # name, sha256
    missing: tuple[str, ...]  # sha256


@dataclass
class _Detecting:
    """Detection under way."""

    waiting: Iterator[str]
    done: int
    unusable: dict[str, str] = field(default_factory=dict)  # sha256: why


class MapBuilder:
    """Builds target maps: rows by threads, pixels and adjustments by the pool."""

    def __init__(self, database: Database, pool: CpuPool, limits: BuildLimits) -> None:
        self._database = database
        self._pool = pool
        self._limits = limits

    async def build(self, job: Job) -> None:
        """Run one build to its end; the job is then ``succeeded`` and its map published, in one transaction.

        Raises
        ------
        Cancelled
            When the job was cancelled meanwhile.
        ScattermarkError
            Whatever ends the build; nothing is published then.
        """
        options = BuildOptions.from_json(job.options)
        plan = await asyncio.to_thread(self._plan, job, options)
        unusable = await self._detect_each(job, plan)
        unreadable = tuple(Unreadable(name, unusable[sha256]) for name, sha256 in plan.photos if sha256 in unusable)
        await self._work(adjust_and_publish, AdjustTask(job.job_id, unreadable), self._limits.adjust_timeout_s)

    def _plan(self, job: Job, options: BuildOptions) -> _Plan:
        with self._database.reading() as session:
            family = SiteRepository(session).get(job.site_id).code_family
            settings = DetectSettings.of(family, options)
            photos = tuple(
                (photo.name, photo.sha256)
                for photo in SurveyRepository(session).photos(job.survey_id)
                if photo.name not in options.exclude.images
            )
            missing = DetectionRepository(session).missing(settings.key(sha256) for _, sha256 in photos)
        return _Plan(settings, photos, tuple(key.sha256 for key in missing))

    async def _detect_each(self, job: Job, plan: _Plan) -> dict[str, str]:
        """Detect in all photographs that are new to the detector; why some cannot be used, by digest."""
        progress = JobProgress(self._database, job.job_id)
        total = len({sha256 for _, sha256 in plan.photos})
        detecting = _Detecting(iter(plan.missing), total - len(plan.missing))

        async def detect_on() -> None:
            for sha256 in detecting.waiting:
                await asyncio.to_thread(progress.report, "detect", detecting.done, total)
                reason = await self._detect_one(DetectTask(sha256, plan.settings, self._limits.photo))
                if reason is not None:
                    detecting.unusable[sha256] = reason
                detecting.done += 1

        try:
            async with asyncio.TaskGroup() as group:
                for _ in range(self._limits.width):
                    group.create_task(detect_on())
        except ExceptionGroup as errors:
            raise errors.exceptions[0] from None
        await asyncio.to_thread(progress.report, "detect", total, total)
        return detecting.unusable

    async def _detect_one(self, task: DetectTask) -> str | None:
        try:
            reason: str | None = await self._work(detect_photo, task, self._limits.detect_timeout_s)
        except (TimedOut, WorkerCrashed) as error:  # one hostile photograph must not end the survey
            return error.detail
        return reason

    async def _work(self, function: Callable[..., Any], task: object, timeout_s: float) -> Any:
        """Run a step in the pool; when the build is cancelled, the worker that does it is ended."""
        future = self._pool.submit(function, task, timeout_s=timeout_s)
        try:
            return await asyncio.shield(asyncio.wrap_future(future))
        except asyncio.CancelledError:
            future.cancel()
            raise
