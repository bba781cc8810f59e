"""A worker put together: settings -> database, pool, engine -> the loop that takes jobs, until it is told to stop."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress

from app.errors import StorageUnavailable
from app.jobs.chores import Chores
from app.jobs.engine import Engine, prepare_tables
from app.jobs.foreman import TURN_S, Foreman, GivenUp, Place
from app.jobs.fork_server import start_fork_server
from app.jobs.pool import WorkerPool
from app.jobs.slot import Slot, held_slot
from app.jobs.worker_metrics import metrics_served
from app.jobs.workflows import Crew, sign_on, the_crew
from app.services.alerts import WatchRound
from app.services.build_map import BuildLimits, MapBuilder
from app.services.housekeeping import housekeep
from app.services.workers import start_worker
from app.settings import Settings
from app.storage.database import Database
from app.storage.migrate import check_tables
from app.storage.photo_store import open_photo_store
from app.storage.workers import WorkerRepository
from app.vision.photo import PhotoLimits

log = logging.getLogger(__name__)

SLOTS_FOLDER = "workers"
# Chunks that a worker takes, per pool process: one under way and one at hand, so that none waits for the next look.
CHUNKS_PER_PROCESS = 2
# Chunks, and builds that are adjusted, begun here and resumed here: what may ever be in the pool's queue.
QUEUE_PER_PROCESS = CHUNKS_PER_PROCESS + 2
STOPPED = 0
GIVEN_UP = 75  # exit status: try again


def run_worker(settings: Settings, stop: threading.Event, ready: Callable[[str], None]) -> int:
    """Do builds until told to stop; the exit status.

    What is under way then is not finished: it stays in the database, and the next worker goes on with it. The caller
    ends the process at once after this returns: threads of the engine are still at work, and must say nothing more.

    Parameters
    ----------
    settings : Settings
    stop : Event
        Set when the worker shall stop.
    ready : callable
        Is told the worker's name once it takes jobs.

    Raises
    ------
    WrongTables
        When the database waits for a migration.
    StorageUnavailable
        When the database gives no answer at the start.
    """
    database = Database(settings.sqlalchemy_url)
    check_tables(database)
    start_fork_server(start_worker.__module__)
    with held_slot(settings.data_dir / SLOTS_FOLDER) as slot:
        pool = _started_pool(settings)
        with metrics_served(settings.worker_metrics_port, pool, database), _signed_up(database, slot) as worker_id:
            sign_on(Crew(database, _builder(settings, database, pool), worker_id))
            engine = Engine(settings.engine_url, worker_id, settings.build_workers * CHUNKS_PER_PROCESS)
            Chores(_chores(settings, database, engine)).start()
            ready(slot.name)
            return _work(Foreman(the_crew(), engine, Place(worker_id, slot.key, settings.build_workers)), stop)


def _chores(settings: Settings, database: Database, engine: Engine) -> dict[str, Callable[[], object]]:
    photos = open_photo_store(settings.photographs_location)
    return {
        "housekeeping": lambda: housekeep(database, photos, time.time()),
        "maps watched": WatchRound(database),
        "ended builds forgotten by the engine": engine.forget_ended,
    }


def _work(foreman: Foreman, stop: threading.Event) -> int:
    try:
        while not stop.wait(TURN_S):
            foreman.turn()
    except GivenUp:
        log.warning("the other workers took this one for dead and have its work; it ends, and may be started again")
        return GIVEN_UP
    return STOPPED


def _started_pool(settings: Settings) -> WorkerPool:
    """The pool with its processes warm, and the engine's tables, which are made meanwhile."""
    bench = (settings.sqlalchemy_url, settings.photographs_location)
    depth = settings.build_workers * QUEUE_PER_PROCESS
    pool = WorkerPool(settings.build_workers, depth, start_worker, bench)
    with ThreadPoolExecutor(max_workers=1) as aside:
        tables = aside.submit(prepare_tables, settings.engine_url)
        pool.start()
        tables.result()
    return pool


def _builder(settings: Settings, database: Database, pool: WorkerPool) -> MapBuilder:
    photo = PhotoLimits(settings.max_photo_bytes, settings.max_photo_pixels)
    return MapBuilder(database, pool, BuildLimits(photo, settings.detect_timeout_s, settings.adjust_timeout_s))


@contextmanager
def _signed_up(database: Database, slot: Slot) -> Iterator[str]:
    """Stand in the table of workers; in the end say that this worker leaves, so that others need not wait for it."""
    with database.writing() as session:
        worker_id = WorkerRepository(session).add(slot.name, slot.key)
    yield worker_id
    with suppress(StorageUnavailable), database.writing() as session:  # else the others notice by themselves
        WorkerRepository(session).leave(worker_id)
