"""The story of a survey: photographs -> detect each -> adjust -> publish the target map.

Each method is one step of a build, which an engine calls and may call again: whatever was done before stays done. What
steps hand to each other is small and JSON; detections and maps go to the database.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from app.errors import Cancelled, TimedOut, WorkerCrashed
from app.services.adjust_work import AdjustTask, Unreadable, adjust_and_publish
from app.services.build_tasks import BuildTasks
from app.services.calibrate_work import calibrate_and_keep
from app.services.detect_work import DetectSettings, DetectTask, detect_photo
from app.services.job_kinds import BUILD, CALIBRATE, reading_options
from app.services.job_progress import JobProgress
from app.services.ports import CpuPool
from app.storage.database import Database, Session
from app.storage.job_queue import JobQueue
from app.storage.jobs import JobRepository, JobRun
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.vision.photo import PhotoLimits

log = logging.getLogger(__name__)

PHOTOS_PER_CHUNK = 4  # of 4 to 8: a chunk then takes about a second, 50 times what the engine adds to it
CRASHES_FORGIVEN = 1  # a process may be killed from outside; when the next one dies of the same work, it is the work
LOOK_INTERVAL_S = 0.3  # whoever watches a build sees its photographs counted three times a second

# What is done once all photographs are detected, by kind of job.
LAST_STEPS: dict[str, Callable[[AdjustTask], int | str]] = {BUILD: adjust_and_publish, CALIBRATE: calibrate_and_keep}

Chunks = tuple[tuple[str, ...], ...]  # digests of photographs
Reasons = dict[str, str]  # why a photograph cannot be used, by digest


@dataclass(frozen=True)
class BuildLimits:
    """How long the parts of a build may take.

    Attributes
    ----------
    photo : PhotoLimits
    detect_timeout_s, adjust_timeout_s : float
        Of one photograph and of the adjustment.
    """

    photo: PhotoLimits
    detect_timeout_s: float
    adjust_timeout_s: float


class MapBuilder:
    """Builds target maps: rows here, pixels and adjustments in the pool."""

    def __init__(self, database: Database, pool: CpuPool, limits: BuildLimits) -> None:
        self._database = database
        self._pool = pool
        self._limits = limits
        self.tasks = BuildTasks()

    def plan(self, run: JobRun) -> Chunks:
        """The photographs that were never detected with the build's settings, in chunks.

        Raises
        ------
        NotFound
            When the job or its survey is gone.
        """
        with self._database.reading() as session:
            settings, digests = _wanted(session, run)
            missing = DetectionRepository(session).missing(settings.key(sha256) for sha256 in digests)
        new = [key.sha256 for key in missing]
        return tuple(tuple(new[at : at + PHOTOS_PER_CHUNK]) for at in range(0, len(new), PHOTOS_PER_CHUNK))

    def detect(self, run: JobRun, digests: Iterable[str]) -> Reasons:
        """Detect in the photographs of a chunk that have not been detected meanwhile; why some cannot be used.

        Raises
        ------
        Cancelled
            When the attempt is over.
        """
        reasons: Reasons = {}
        with self._database.reading() as session:
            settings, _ = _wanted(session, run)
            missing = DetectionRepository(session).missing(settings.key(sha256) for sha256 in digests)
        for key in missing:
            self._check_running(run)
            reason = self._detect_one(run, DetectTask(key.sha256, settings, self._limits.photo))
            if reason is not None:
                reasons[key.sha256] = reason
        with self._database.writing() as session:
            JobQueue(session).got_on(run)
        return reasons

    def await_detection(self, run: JobRun, detecting: Callable[[], bool]) -> None:
        """Say how many photographs are detected, by whatever worker, while ``detecting`` says that some are not.

        Raises
        ------
        Cancelled
            When the attempt is over.
        """
        progress = JobProgress(self._database, run)
        with self._database.reading() as session:
            settings, digests = _wanted(session, run)
        missing = tuple(settings.key(sha256) for sha256 in digests)
        while detecting():
            with self._database.reading() as session:
                missing = DetectionRepository(session).missing(missing)
            # Those that cannot be used stay missing: the stage is complete when the chunks are, not before.
            progress.report("detect", min(len(digests) - len(missing), len(digests) - 1), len(digests))
            time.sleep(LOOK_INTERVAL_S)
        progress.report("detect", len(digests), len(digests))

    def adjust_and_publish(self, run: JobRun, reasons: Reasons) -> int | str:
        """Adjust the survey and publish its map, or calibrate the camera: once. The map's version or the camera's id.

        Raises
        ------
        Cancelled
            When the attempt is over; nothing is published.
        ScattermarkError
            Whatever ends the build.
        """
        self._check_running(run)
        with self._database.reading() as session:
            job = JobRepository(session).get(run.job_id)
            photos = SurveyRepository(session).photos(job.survey_id)
        unreadable = tuple(Unreadable(photo.name, reasons[photo.sha256]) for photo in photos if photo.sha256 in reasons)
        work = LAST_STEPS[job.kind]
        published: int | str = self._work(run, work, AdjustTask(run, unreadable), self._limits.adjust_timeout_s)
        return published

    def _detect_one(self, run: JobRun, task: DetectTask) -> str | None:
        try:
            reason: str | None = self._work(run, detect_photo, task, self._limits.detect_timeout_s)
        except (TimedOut, WorkerCrashed) as error:  # one hostile photograph must not end the survey
            return error.detail
        return reason

    def _work(self, run: JobRun, function: Callable[..., Any], task: object, timeout_s: float) -> Any:
        """Have the pool do a part; it is ended with the attempt, and done again when its process dies."""
        for _ in range(CRASHES_FORGIVEN):
            try:
                return self._work_once(run, function, task, timeout_s)
            except WorkerCrashed as error:
                log.warning("job %s: %s; it is tried again", run.job_id, error.detail)
        return self._work_once(run, function, task, timeout_s)

    def _work_once(self, run: JobRun, function: Callable[..., Any], task: object, timeout_s: float) -> Any:
        future = self._pool.submit(function, task, timeout_s=timeout_s)
        with self.tasks.watching(run, future):
            return future.result()

    def _check_running(self, run: JobRun) -> None:
        with self._database.reading() as session:
            running = JobQueue(session).still_running([run])
        if not running:
            raise Cancelled("the job was cancelled", job_id=run.job_id)


def _wanted(session: Session, run: JobRun) -> tuple[DetectSettings, tuple[str, ...]]:
    """How a build reads its photographs, and their digests, each once."""
    job = JobRepository(session).get(run.job_id)
    options = reading_options(job)
    family = SiteRepository(session).get(job.site_id).code_family
    photos = SurveyRepository(session).photos(job.survey_id)
    digests = dict.fromkeys(photo.sha256 for photo in photos if photo.name not in options.exclude.images)
    return DetectSettings.of(family, options), tuple(digests)
