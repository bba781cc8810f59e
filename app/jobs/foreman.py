"""The loop of a worker: say that it lives, look at the others, take jobs, end what was cancelled."""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass

from app.errors import StorageUnavailable
from app.jobs.engine import Engine, Known
from app.jobs.lookout import BEAT_INTERVAL_S, Lookout
from app.jobs.reaper import Reaper
from app.jobs.workflows import Crew
from app.storage.job_queue import JobQueue
from app.storage.jobs import JobRun
from app.storage.workers import WorkerRepository

log = logging.getLogger(__name__)

TURN_S = 0.25  # a job that is asked for begins, and one that is cancelled ends, within this time
CHECK_INTERVAL_S = 5.0  # between two looks for jobs that nobody is at work on though the table says this worker is


class GivenUp(Exception):
    """The others have declared this worker dead: its work is theirs now."""


@dataclass(frozen=True)
class Place:
    """Where a worker stands among the others.

    Attributes
    ----------
    slot : str
        Held by this process, so whoever else has it in the table is dead.
    builds : int
        Builds that it takes at a time.
    """

    worker_id: str
    slot: str
    builds: int


class Foreman:
    """Keeps the table of jobs and the engine in step, for one worker; ``turn`` is called again and again.

    Parameters
    ----------
    crew : Crew
    engine : Engine
    place : Place
    """

    def __init__(self, crew: Crew, engine: Engine, place: Place) -> None:
        self._crew = crew
        self._database = crew.database
        self._engine = engine
        self._place = place
        self._reaper = Reaper(crew.database, engine)
        self._lookout = Lookout()
        self._beat_s = self._check_s = float("-inf")
        self._suspects: frozenset[JobRun] = frozenset()
        self._ended: frozenset[JobRun] = frozenset()

    def turn(self) -> None:
        """One round; a database that gives no answer is asked again in the next.

        Raises
        ------
        GivenUp
            When the worker has to end, at once: others do its work.
        """
        try:
            self._turn(time.monotonic())
        except StorageUnavailable as error:
            self._lookout.look_failed()
            log.warning("the jobs cannot be read: %s", error.detail)

    def _turn(self, now_s: float) -> None:
        if now_s - self._beat_s >= BEAT_INTERVAL_S:
            self._beat()
            self._look()
            self._beat_s = now_s
        if now_s - self._check_s >= CHECK_INTERVAL_S:
            self._check()
            self._check_s = now_s
        self._take()
        self._end_cancelled()

    def _beat(self) -> None:
        with self._database.writing() as session:
            if not WorkerRepository(session).beat(self._place.worker_id):
                raise GivenUp

    def _look(self) -> None:
        with self._database.reading() as session:
            workers = WorkerRepository(session).workers()
        others = [worker for worker in workers if worker.worker_id != self._place.worker_id]
        before_us = [worker for worker in others if worker.slot == self._place.slot]
        for dead in (*before_us, *self._lookout.look(worker for worker in others if worker not in before_us)):
            self._reaper.reap(dead)

    def _take(self) -> None:
        """Begin waiting jobs, or go on with those that a worker has left, as far as there is room."""
        room = self._place.builds - len(self._crew.active)
        if room <= 0:
            return
        with self._database.reading() as session:
            waiting = JobQueue(session).waiting(room)
        for job in waiting:
            with self._database.writing() as session:
                claimed = JobQueue(session).claim(job.run, self._place.worker_id)
            if claimed:
                self._set_going(job.run)

    def _set_going(self, run: JobRun) -> None:
        """Have the engine work on an attempt that this worker has by the table."""
        known = self._engine.known(run)
        if known is Known.NOTHING:
            self._engine.start(run)
        elif known is Known.UNDER_WAY:  # in a worker that is dead, else the job would not have come to us
            self._engine.resume(run)
        elif known is Known.ENDED:  # the table was restored from a backup, or the end could not be written
            with self._database.writing() as session:
                after = JobQueue(session).begin_anew(run)
            if after is not None:
                self._engine.start(after)

    def _check(self) -> None:
        """Set going what this worker has by the table and is not at work on, twice in a row: a claim that broke off."""
        with self._database.reading() as session:
            ours = JobQueue(session).running_of(self._place.worker_id)
        idle = frozenset(ours) - frozenset(self._crew.active)
        for run in idle & self._suspects:
            self._set_going(run)
        self._suspects = idle - self._suspects

    def _end_cancelled(self) -> None:
        """End what is under way in this worker for jobs that run no more."""
        runs = frozenset(self._crew.active) | self._crew.builder.tasks.runs
        if not runs:
            return
        with self._database.reading() as session:
            over = runs - JobQueue(session).still_running(runs)
        for run in over - self._ended:
            self._engine.cancel(run)
        for run in over:
            self._crew.builder.tasks.end(run)
        self._ended = over
