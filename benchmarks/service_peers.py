"""What the service is compared with, in the same run: the pipeline alone in one process, and the pool alone."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from pathlib import Path

import cv2
from threadpoolctl import threadpool_limits

from app.jobs.pool import WorkerPool
from app.services.choose_camera import KnownCameras
from app.services.locate_work import LocateOutcome, LocateTask, locate_photo
from app.services.workers import start_locating
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.snapshots import Located
from app.vision.photo import PhotoLimits

WAITING_PER_WORKER = 2  # so that none is ever without work


@contextmanager
def bare_pipeline(database_url: str, photographs: str) -> Iterator[None]:
    """Make this process one that can locate, single-threaded as a worker is."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    with threadpool_limits(limits=1):
        start_locating(database_url, photographs)
        yield
    cv2.setNumThreads(threads)


def task_of(database_url: str, site_id: str, photo: Path) -> LocateTask:
    """What the service hands to its pool for a photograph."""
    database = Database(database_url)
    with database.reading() as session:
        stored = CameraRepository(session).candidates(site_id, None)
    database.close()
    return LocateTask(photo.read_bytes(), PhotoLimits(), site_id, 1, KnownCameras(stored=stored))


def bare_s(task: LocateTask) -> float:
    """Seconds that the pipeline takes in this process."""
    began_s = time.perf_counter()
    _check(locate_photo(task))
    return time.perf_counter() - began_s


def pool_per_s(pool: WorkerPool, workers: int, task: LocateTask, count: int) -> float:
    """Snapshots a second that a pool computes when it never waits."""
    waiting: set[Future[LocateOutcome]] = set()
    submitted, done = 0, 0
    began_s = time.perf_counter()
    while done < count:
        while submitted < count and len(waiting) < workers * WAITING_PER_WORKER:
            waiting.add(pool.submit(locate_photo, task))
            submitted += 1
        finished, waiting = wait(waiting, return_when=FIRST_COMPLETED)
        for future in finished:
            _check(future.result())
        done += len(finished)
    return count / (time.perf_counter() - began_s)


def _check(outcome: LocateOutcome) -> None:
    if not isinstance(outcome.outcome, Located):
        raise SystemExit(f"the photograph cannot be located: {outcome.outcome.detail}")
