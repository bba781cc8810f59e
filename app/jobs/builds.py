"""Builds in the background: one after the other, each cancellable, each ending in a state that says how.

The queue is the job table, so that the state survives; running them durably needs only another runner with this face.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import socket
import uuid

from app.errors import Cancelled, ScattermarkError
from app.services.build_map import MapBuilder
from app.services.jobs import problem_of_error
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository

log = logging.getLogger(__name__)

POLL_INTERVAL_S = 2.0  # a job that another process put into the table is found within this time
RETRY_PAUSE_S = 1.0


class BuildRunner:
    """Takes waiting builds from the database, the oldest first, and runs one at a time over the whole pool."""

    def __init__(self, database: Database, builder: MapBuilder) -> None:
        self._database = database
        self._builder = builder
        self._owner = f"{socket.gethostname()}/{os.getpid()}"
        self._loop: asyncio.AbstractEventLoop | None = None
        self._wanted = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self._running: tuple[str, asyncio.Task[None]] | None = None

    async def start(self) -> None:
        """Close the books on builds that died with their process, then take what waits."""
        self._loop = asyncio.get_running_loop()
        await asyncio.to_thread(self._bury_the_dead)
        self._task = asyncio.create_task(self._run_forever())

    async def close(self) -> None:
        """End the running build, which is then ``failed``, and take no other."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task

    def wake(self) -> None:
        """Look for waiting builds now; from any thread."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._wanted.set)

    def stop(self, job_id: str) -> None:
        """End the work on a cancelled build; from any thread."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._stop_running, job_id)

    def _stop_running(self, job_id: str) -> None:
        if self._running is not None and self._running[0] == job_id:
            self._running[1].cancel()

    async def _run_forever(self) -> None:
        while True:
            try:
                job = await asyncio.to_thread(self._claim)
            except ScattermarkError:
                log.exception("the waiting builds cannot be read; trying again in %s s", RETRY_PAUSE_S)
                await asyncio.sleep(RETRY_PAUSE_S)
                continue
            if job is None:
                await self._wait_for_work()
                continue
            work = asyncio.create_task(self._run(job))
            self._running = job.job_id, work
            try:
                await asyncio.shield(asyncio.wait({work}))
            except asyncio.CancelledError:  # the server stops: the build ends before it does
                work.cancel()
                await asyncio.wait({work})
                raise
            finally:
                self._running = None

    async def _wait_for_work(self) -> None:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._wanted.wait(), POLL_INTERVAL_S)
        self._wanted.clear()

    async def _run(self, job: Job) -> None:
        """Run a build; however it ends, its row says so."""
        try:
            await self._builder.build(job)
        except Cancelled:
            log.info("job %s was cancelled", job.job_id)
        except ScattermarkError as error:
            await asyncio.to_thread(self._fail, job.job_id, error)
        except asyncio.CancelledError:
            await asyncio.to_thread(self._fail, job.job_id, _stopped())  # changes nothing when the user cancelled it
        except Exception:  # a fault of ours must not end the runner
            incident = uuid.uuid4().hex
            log.exception("job %s failed, incident %s", job.job_id, incident)
            await asyncio.to_thread(self._fail, job.job_id, _fault(incident))

    def _claim(self) -> Job | None:
        """The oldest waiting build, now ours."""
        with self._database.reading() as session:
            waiting = [job for job in JobRepository(session).open_jobs() if job.state == "queued"]
        for job in waiting:
            with self._database.writing() as session:
                if JobRepository(session).claim(job.job_id, self._owner):
                    return job
        return None

    def _fail(self, job_id: str, error: ScattermarkError) -> None:
        with self._database.writing() as session:
            JobRepository(session).fail(job_id, problem_of_error(error))

    def _bury_the_dead(self) -> None:
        """Builds that were running when their process died will never end by themselves."""
        with self._database.writing() as session:
            jobs = JobRepository(session)
            for job in jobs.open_jobs():
                if job.state == "running" and _is_dead(job.owner or ""):
                    jobs.fail(job.job_id, problem_of_error(_stopped()))


def _is_dead(owner: str) -> bool:
    """Whether the process that ran a job is gone; of another machine's processes nothing is known."""
    host, _, pid = owner.rpartition("/")
    if host != socket.gethostname():
        return False
    if int(pid) == os.getpid():  # in a container the number comes back at each start
        return True
    try:
        os.kill(int(pid), 0)
    except ProcessLookupError:
        return True
    except PermissionError:
        return False
    return False


def _stopped() -> ScattermarkError:
    return BuildInterrupted("the server stopped while the build ran; nothing was published, start the build again")


def _fault(incident: str) -> ScattermarkError:
    return ScattermarkError(
        f"the build failed by a fault of the server; start it again, and report incident {incident} if it stays so",
        incident=incident,
    )


class BuildInterrupted(ScattermarkError):
    """A build whose process ended."""

    slug = "build-interrupted"
