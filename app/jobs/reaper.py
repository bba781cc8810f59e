"""What a dead worker was at work on is given to the living, once."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import dataclass

from app.errors import ScattermarkError
from app.jobs.engine import Engine, LeftBehind
from app.services.jobs import problem_of_error
from app.storage.database import Database, Session
from app.storage.job_queue import JobQueue
from app.storage.jobs import JobRepository, JobRun
from app.storage.workers import Worker, WorkerRepository

log = logging.getLogger(__name__)

# Workers that may die over a job without a chunk of photographs done in between. A machine that is switched off again
# and again gets on between two times; a job that fills the memory does not.
STRIKES_BORNE = 5


@dataclass(frozen=True)
class Reaper:
    """Takes over from dead workers. Several may see the same death: the lock on the dead one's row lets one act."""

    database: Database
    engine: Engine

    def reap(self, dead: Worker) -> None:
        """Put a dead worker's builds back into the queue, let others do its chunks, forget it.

        When this worker dies in the middle of it, the row stays and the next one does what is left.
        """
        with self.database.writing() as session:
            workers = WorkerRepository(session)
            if not workers.lock(dead.worker_id):
                return
            left = self.engine.left_behind(dead.worker_id)
            owned = frozenset(JobQueue(session).running_of(dead.worker_id))
            runs = owned | left.builds | frozenset(left.chunks.values())
            hopeless = frozenset() if dead.left else self._strike(session, runs)
            self._pass_on(session, left, owned, hopeless)
            workers.remove(dead.worker_id)
        log.warning("worker %s is gone; %d of its jobs go on elsewhere", dead.name, len(runs - hopeless))

    def _strike(self, session: Session, runs: Iterable[JobRun]) -> frozenset[JobRun]:
        """Count the death against the jobs; those that are given up."""
        JobQueue(session).strike([run.job_id for run in runs])
        jobs = [JobRepository(session).get(run.job_id) for run in JobQueue(session).still_running(tuple(runs))]
        given_up = [job.run for job in jobs if job.strikes > STRIKES_BORNE]
        for run in given_up:
            JobRepository(session).fail(run, problem_of_error(_deadly()))
        return frozenset(given_up)

    def _pass_on(
        self, session: Session, left: LeftBehind, owned: frozenset[JobRun], hopeless: frozenset[JobRun]
    ) -> None:
        queue = JobQueue(session)
        builds = (owned | left.builds) - hopeless
        alive = queue.still_running(tuple(builds | frozenset(left.chunks.values())))
        queue.hand_back([run.job_id for run in builds & alive])
        chunks = [workflow_id for workflow_id, run in left.chunks.items() if run in alive]
        if chunks:
            self.engine.resume_chunks(chunks)
        for run in (left.builds | frozenset(left.chunks.values())) - alive:  # cancelled, failed or removed meanwhile
            self.engine.cancel(run)


class JobKillsWorkers(ScattermarkError):
    """A job that its workers died over again and again."""

    slug = "job-kills-workers"


def _deadly() -> JobKillsWorkers:
    return JobKillsWorkers(
        f"{STRIKES_BORNE + 1} worker processes died in a row while they were at work on this job, most likely for want "
        "of memory; give the workers more of it or split the survey, then try the job again"
    )
