"""A build as the engine runs it: plan, chunks of photographs over all workers, adjust and publish.

The engine calls these functions again after a worker's death, and answers for each step that was done with its result
of then. What the steps do stands in ``app/services/build_map.py``; here is only their order.
"""

from __future__ import annotations

import logging
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypedDict

from dbos import DBOS

from app.errors import Cancelled, ScattermarkError, ServerFull, StorageUnavailable
from app.jobs.engine_json import FAULT
from app.logs import logging_with
from app.services.build_map import MapBuilder, Reasons
from app.services.jobs import problem_of_error
from app.storage.database import Database
from app.storage.job_queue import JobQueue
from app.storage.jobs import JobRepository, JobRun

log = logging.getLogger(__name__)

BUILD, CHUNK = "build", "chunk"  # names of the workflows
BUILDS, CHUNKS = "builds", "chunks"  # names of the queues
BUSY = ("ENQUEUED", "PENDING", "DELAYED")


class Patience(TypedDict):
    """How often a step is tried when the fault is not its own."""

    retries_allowed: bool
    interval_seconds: float
    backoff_rate: float
    max_attempts: int


# 1 s, 2 s, 4 s ...: five minutes in all, in which a database restarts.
PATIENCE = Patience(retries_allowed=True, interval_seconds=1.0, backoff_rate=2.0, max_attempts=9)


def passing(error: BaseException) -> bool:
    """Whether a step may succeed at the next try: the database was away, the pool full."""
    return isinstance(error, (StorageUnavailable, ServerFull))


class Crew:
    """What the workflows of this process work with.

    Parameters
    ----------
    database : Database
    builder : MapBuilder
    worker_id : str
    """

    def __init__(self, database: Database, builder: MapBuilder, worker_id: str) -> None:
        self.database = database
        self.builder = builder
        self.worker_id = worker_id
        self.active: set[JobRun] = set()

    @contextmanager
    def building(self, run: JobRun) -> Iterator[bool]:
        """Take an attempt for the time of the block; False when its job runs no more."""
        with self.database.writing() as session:
            taken = JobQueue(session).take(run, self.worker_id)
        self.active.add(run)
        try:
            with logging_with({"job_id": run.job_id}):
                yield taken
        finally:
            self.active.discard(run)

    def fail(self, run: JobRun, error: ScattermarkError) -> None:
        """End a job with a problem; nothing changes when it has ended otherwise."""
        with self.database.writing() as session:
            JobRepository(session).fail(run, problem_of_error(error))


class _Process:
    """The one crew of this process."""

    crew: Crew | None = None


def sign_on(crew: Crew) -> None:
    """Set up this process, before the engine starts."""
    _Process.crew = crew


def the_crew() -> Crew:
    """The crew of this process."""
    if _Process.crew is None:
        raise RuntimeError("sign_on was not called in this process; the engine must not start before")
    return _Process.crew


@DBOS.workflow(name=BUILD, max_recovery_attempts=None)
def build(job_id: str, attempt: int) -> None:
    """One attempt at a build; however it ends, the job's row says so."""
    run = JobRun(job_id, attempt)
    crew = the_crew()
    with crew.building(run) as taken:
        if not taken:
            return
        try:
            _build(run)
        except Cancelled:
            log.info("job %s was cancelled", job_id)
        except ScattermarkError as error:
            crew.fail(run, _fault(error) if error.slug == FAULT else error)
        except Exception as error:  # a fault of ours must not leave a job that never ends
            log.exception("job %s failed by a fault", job_id)
            crew.fail(run, _fault(error))


def _build(run: JobRun) -> None:
    chunks = plan(run.job_id, run.attempt)
    for digests in chunks:
        DBOS.enqueue_workflow(CHUNKS, chunk, run.job_id, run.attempt, digests)
    reasons = await_chunks(run.job_id, run.attempt)
    adjust_and_publish(run.job_id, run.attempt, reasons)


@DBOS.step(name="plan", should_retry=passing, **PATIENCE)
def plan(job_id: str, attempt: int) -> list[list[str]]:
    """Digests of the photographs that are to be detected."""
    return [list(digests) for digests in the_crew().builder.plan(JobRun(job_id, attempt))]


@DBOS.workflow(name=CHUNK, max_recovery_attempts=None)
def chunk(job_id: str, attempt: int, digests: list[str]) -> Reasons:
    """Some photographs of a build, on whatever worker; why some of them cannot be used."""
    try:
        with logging_with({"job_id": job_id}):
            return detect(job_id, attempt, digests)
    except Cancelled:
        return {}


@DBOS.step(name="detect", should_retry=passing, **PATIENCE)
def detect(job_id: str, attempt: int, digests: list[str]) -> Reasons:
    """Detect in each photograph of a chunk."""
    return the_crew().builder.detect(JobRun(job_id, attempt), digests)


@DBOS.step(name="await_chunks", should_retry=passing, **PATIENCE)
def await_chunks(job_id: str, attempt: int) -> Reasons:
    """Say how far the chunks are until all are done; what they found unusable, together."""
    parent = DBOS.workflow_id
    assert parent is not None

    def detecting() -> bool:
        return bool(DBOS.list_workflows(parent_workflow_id=parent, status=list(BUSY), limit=1, load_input=False))

    the_crew().builder.await_detection(JobRun(job_id, attempt), detecting)
    reasons: Reasons = {}
    for done in DBOS.list_workflows(parent_workflow_id=parent, load_input=False):
        reasons.update(DBOS.retrieve_workflow(done.workflow_id).get_result())  # raises what the chunk raised
    return reasons


@DBOS.step(name="adjust_and_publish", should_retry=passing, **PATIENCE)
def adjust_and_publish(job_id: str, attempt: int, reasons: Reasons) -> int | str:
    """Adjust and publish the map, or the camera, in one step: between the two there is nothing to lose but a moment."""
    return the_crew().builder.adjust_and_publish(JobRun(job_id, attempt), reasons)


def _fault(error: BaseException) -> ScattermarkError:
    incident = uuid.uuid4().hex
    log.error("incident %s: %r", incident, error)
    return ScattermarkError(
        f"the build failed by a fault of the server; try it again, and report incident {incident} if it stays so",
        incident=incident,
    )
