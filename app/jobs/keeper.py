"""A thread that looks after one worker: feeds it, watches it, replaces it."""

from __future__ import annotations

import logging
import queue
import threading
from typing import Any

from app.errors import Cancelled, TimedOut, WorkerCrashed
from app.jobs.task import Task
from app.jobs.worker import WorkerSetup
from app.jobs.worker_process import WorkerGone, WorkerProcess
from app.logs import logging_with

log = logging.getLogger(__name__)


class Keeper(threading.Thread):
    """Takes tasks from a shared queue and has one worker process do them, until it takes None.

    Parameters
    ----------
    waiting : SimpleQueue of Task or None
        Shared by all keepers of a pool.
    setup : WorkerSetup
        What a new worker does first.

    Attributes
    ----------
    busy : bool
        Whether the worker is at work.
    started, crashed, timed_out : int
        Workers that were started, tasks that one died of, tasks that outlasted their time limit.
    """

    def __init__(self, waiting: queue.SimpleQueue[Task | None], setup: WorkerSetup) -> None:
        super().__init__(name="worker-keeper", daemon=True)
        self._waiting = waiting
        self._setup = setup
        self._worker: WorkerProcess | None = None
        self._first_start = threading.Event()
        self._start_error: WorkerCrashed | None = None
        self.busy = False
        self.started = 0
        self.crashed = 0
        self.timed_out = 0

    @property
    def pid(self) -> int | None:
        """Process id of the worker; None while there is none."""
        return None if self._worker is None else self._worker.pid

    def wait_ready(self) -> WorkerCrashed | None:
        """Wait for the first worker; the error when it did not start."""
        self._first_start.wait()
        return self._start_error

    def run(self) -> None:
        """The thread's life."""
        self._replace_dead()
        self._first_start.set()
        while (task := self._waiting.get()) is not None:
            if task.begin():
                self._perform(task)
                self._replace_dead()  # now, so that the next task does not wait for a process to start
        if self._worker is not None:
            self._worker.close()

    def _replace_dead(self) -> None:
        try:
            self._living_worker()
        except WorkerCrashed as error:
            self._start_error = error  # the next task tries again and, failing that, carries the error

    def _living_worker(self) -> WorkerProcess:
        if self._worker is not None and self._worker.is_alive():
            return self._worker
        if self._worker is not None:
            self._worker.close()
            self._worker = None
        self._worker = WorkerProcess(self._setup)
        self.started += 1
        return self._worker

    def _perform(self, task: Task) -> None:
        self.busy = True
        try:
            value = self._exchange(task)
        except BaseException as error:  # noqa: BLE001 - it belongs to whoever waits for the task
            self._note(task, error)
            self.busy = False
            self._settle(task, None, error)
        else:
            self.busy = False
            self._settle(task, value, None)

    def _note(self, task: Task, error: BaseException) -> None:
        """Count and log what became of the worker; whoever waits for the task gets the error in any case."""
        if task.end_wanted or not isinstance(error, WorkerCrashed | TimedOut):
            return
        if isinstance(error, TimedOut):
            self.timed_out += 1
        else:
            self.crashed += 1
        with logging_with(task.context):
            log.warning("a worker process is lost: %s", error.detail, extra={"task": task.function.__name__})

    def _exchange(self, task: Task) -> Any:
        try:
            worker = self._hand_over(task)
        except WorkerGone:
            worker = self._hand_over(task)
        try:
            return worker.receive(task.timeout_s)
        finally:
            task.detach()

    def _hand_over(self, task: Task) -> WorkerProcess:
        worker = self._living_worker()
        task.attach(worker.kill)
        worker.hand_over(task.function, task.args, task.context)
        return worker

    @staticmethod
    def _settle(task: Task, value: Any, error: BaseException | None) -> None:
        if task.end_wanted:
            task.set_exception(Cancelled("the work was ended on request"))
        elif error is not None:
            task.set_exception(error)
        else:
            task.set_result(value)
