"""The engine, DBOS Transact, behind five verbs: start, resume, cancel, ask, forget. Only workers import it.

It remembers which steps of a build are done; the job table says which builds there are. One workflow is one attempt at
a build, and its id says so. What the engine says of a job counts only as long as the table says that the job runs.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from enum import Enum
from pathlib import Path

from dbos import DBOS, DBOSConfig, SetWorkflowID, WorkflowStatus
from sqlalchemy import make_url

from app.jobs import workflows
from app.jobs.engine_json import JsonSerializer
from app.storage.jobs import JobRun

# Part of every workflow's id: workers of another version leave these workflows alone, and begin the builds anew. Change
# it when the order of a build's steps, or what they hand to each other, changes.
VERSION = "jobs-1"
SCHEMA = "dbos"  # of the engine's tables on Postgres
APPLICATION = "scattermark"
CHUNKS_POLL_S = 0.25  # a chunk takes about a second, and one is at hand beside those under way
BUILDS_POLL_S = 1.0  # of builds whose worker died, which was found out in seconds
POOL_SIZE = 10  # connections to the engine's database: one per chunk under way and a few threads of its own
FORGET_AFTER = timedelta(hours=1)  # an ended build is told by the job table; the engine's record is for whoever debugs
FORGOTTEN_AT_ONCE = 200

UNDER_WAY = ("PENDING",)
WAITING = ("ENQUEUED", "DELAYED")
ENDED = ("SUCCESS", "ERROR", "CANCELLED", "MAX_RECOVERY_ATTEMPTS_EXCEEDED")


class Known(Enum):
    """What the engine knows of an attempt."""

    NOTHING = "nothing"
    WAITING = "waiting"
    UNDER_WAY = "under way"
    ENDED = "ended"


@dataclass(frozen=True)
class LeftBehind:
    """What was under way in a worker: builds, and chunks of builds by their workflow ids."""

    builds: frozenset[JobRun]
    chunks: dict[str, JobRun]


def workflow_id_of(run: JobRun) -> str:
    """Name of an attempt in the engine."""
    return f"{VERSION}/{run.job_id}/{run.attempt}"


def prepare_tables(url: str) -> None:
    """Make the engine's tables, or bring them to what this release of it needs.

    Parameters
    ----------
    url : str
        SQLAlchemy URL of a file of its own on SQLite, of the service's database on Postgres.
    """
    _write_ahead(url)
    DBOS.migrate(url, schema=SCHEMA)


class Engine:
    """The engine of this process; there is one.

    Parameters
    ----------
    url : str
        As for ``prepare_tables``, which comes first.
    worker_id : str
        Never used before and never again: what is under way for it after its death is free to be taken.
    width : int
        Chunks that this worker takes at a time.
    """

    def __init__(self, url: str, worker_id: str, width: int) -> None:
        config = DBOSConfig(
            name=APPLICATION,
            system_database_url=url,
            dbos_system_schema=SCHEMA,
            application_version=VERSION,
            executor_id=worker_id,
            serializer=JsonSerializer(),
            sys_db_pool_size=POOL_SIZE + width,
            log_level="WARNING",
            run_migrations=False,
        )
        DBOS(config=config)
        DBOS.launch()
        self._worker_id = worker_id
        # Builds that are resumed, and chunks, wait in different queues: a build that waits for its chunks must not
        # take their place. The width of the worker that started last is in force for all.
        DBOS.register_queue(workflows.BUILDS, polling_interval_sec=BUILDS_POLL_S)
        DBOS.register_queue(
            workflows.CHUNKS,
            worker_concurrency=width,
            polling_interval_sec=CHUNKS_POLL_S,
            on_conflict="always_update",
        )

    def start(self, run: JobRun) -> None:
        """Begin an attempt in this process; nothing happens when the engine knows it already."""
        with SetWorkflowID(workflow_id_of(run)):
            DBOS.start_workflow(workflows.build, run.job_id, run.attempt)

    def resume(self, run: JobRun) -> None:
        """Let any worker go on with an attempt that nobody is at work on."""
        DBOS.resume_workflow(workflow_id_of(run), queue_name=workflows.BUILDS)

    def resume_chunks(self, workflow_ids: Iterable[str]) -> None:
        """Let any worker do chunks that nobody is at work on."""
        DBOS.resume_workflows(list(workflow_ids), queue_name=workflows.CHUNKS)

    def known(self, run: JobRun) -> Known:
        """What the engine knows of an attempt, as far as it concerns this worker."""
        status = DBOS.get_workflow_status(workflow_id_of(run))
        if status is None:
            return Known.NOTHING
        if status.status in ENDED:
            return Known.ENDED
        return Known.WAITING if status.status in WAITING else Known.UNDER_WAY

    def cancel(self, run: JobRun) -> None:
        """End an attempt and its chunks: no further step of them begins, on any worker."""
        if self.known(run) is not Known.NOTHING:
            DBOS.cancel_workflow(workflow_id_of(run), cancel_children=True)

    def left_behind(self, worker_id: str) -> LeftBehind:
        """What was under way in a worker that is dead."""
        builds, chunks = set(), {}
        for status in _listed(executor_id=worker_id, status=list(UNDER_WAY)):
            run = _run_of(status)
            if status.name == workflows.BUILD:
                builds.add(run)
            else:
                chunks[status.workflow_id] = run
        return LeftBehind(frozenset(builds), chunks)

    def forget_ended(self) -> int:
        """Remove the engine's records of builds that ended some time ago; how many."""
        before = (datetime.now(UTC) - FORGET_AFTER).isoformat()
        ended = _listed(status=list(ENDED), name=workflows.BUILD, completed_before=before, limit=FORGOTTEN_AT_ONCE)
        if ended:
            DBOS.delete_workflows([status.workflow_id for status in ended], delete_children=True)
        return len(ended)


def _listed(**conditions: object) -> list[WorkflowStatus]:
    return DBOS.list_workflows(app_version=VERSION, load_input=False, load_output=False, **conditions)  # type: ignore[arg-type]


def _run_of(status: WorkflowStatus) -> JobRun:
    """The attempt that a workflow belongs to: the engine names a child by its parent, a dash and a number."""
    _, job_id, attempt = status.workflow_id.split("/")
    return JobRun(job_id, int(attempt.split("-")[0]))


def _write_ahead(url: str) -> None:
    """Set the journal of an SQLite file before the engine opens it: a step then costs a quarter."""
    place = make_url(url)
    if place.get_backend_name() == "sqlite":
        with closing(sqlite3.connect(Path(str(place.database)))) as connection:
            connection.execute("PRAGMA journal_mode=WAL")
