"""The pool's side of one worker: its process and the pipe to it."""

from __future__ import annotations

import os
import pickle
import socket
import struct
import sys
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from typing import Any

from app.errors import TimedOut, WorkerCrashed
from app.jobs import worker
from app.jobs.worker import Answer, WorkerSetup

START_TIMEOUT_S = 120.0  # imports and warm-up take 1-2 s on an idle machine; a loaded one may need far longer
TAKE_TIMEOUT_S = 10  # an idle worker takes a task within a millisecond; one that was stopped or is stuck never does
EXIT_TIMEOUT_S = 2.0  # an idle worker ends within milliseconds of losing its pipe; then it is killed


def process_context() -> ForkServerContext | SpawnContext:
    """A start method that shares no threads or locks with the parent: forkserver, or spawn where there is none."""
    if sys.platform == "win32":
        return get_context("spawn")
    forkserver = get_context("forkserver")
    forkserver.set_forkserver_preload([worker.__name__])  # a new worker is forked with the heavy imports done
    return forkserver


class WorkerGone(WorkerCrashed):
    """The worker died while it was idle: the task has not begun, and another worker may take it."""


class WorkerProcess:
    """A living worker; used by one thread at a time, except ``kill``.

    Raises
    ------
    WorkerCrashed
        From the constructor when the worker dies or its initializer fails before it is ready.
    """

    def __init__(self, setup: WorkerSetup) -> None:
        context = process_context()
        self._tasks, child_end = context.Pipe()
        self._process = context.Process(target=worker.work, args=(child_end, setup), daemon=True)
        self._process.start()
        child_end.close()  # else the end of the child would not close the pipe
        _limit_sending(self._tasks)
        try:
            self.receive(START_TIMEOUT_S)
        except BaseException as error:
            self.close()
            raise WorkerCrashed(f"a worker process did not start: {error}") from error

    @property
    def pid(self) -> int | None:
        """Process id."""
        return self._process.pid

    def is_alive(self) -> bool:
        """Whether the process runs, as far as is known: the news of a death may lag behind it."""
        return self._process.is_alive()

    def hand_over(self, function: Callable[..., Any], args: tuple[Any, ...], context: dict[str, Any]) -> None:
        """Give the worker a task, with the ids that its log lines shall bear, and wait until it has taken it.

        Raises
        ------
        WorkerGone
            When it died before: the work has not begun.
        Exception
            Whatever pickling raises when the task cannot travel; the worker is idle still.
        """
        message = pickle.dumps((function, args, context), protocol=pickle.HIGHEST_PROTOCOL)
        try:
            self._tasks.send_bytes(message)
            if not self._tasks.poll(TAKE_TIMEOUT_S):
                raise TimeoutError("the worker does not answer")
            self._tasks.recv_bytes()
        except (EOFError, OSError) as error:  # TimeoutError among them
            self._end()
            raise WorkerGone("the worker process died before it took this work; send the request again") from error

    def receive(self, timeout_s: float | None) -> Any:
        """The task's result.

        Raises
        ------
        TimedOut
            When the time limit passed; the worker is gone.
        WorkerCrashed
            When the worker died.
        BaseException
            What the task raised.
        """
        if not self._tasks.poll(timeout_s):
            self._end()
            raise TimedOut(f"the work outlasted its time limit of {timeout_s:g} s and was ended", timeout_s=timeout_s)
        try:
            answer: Answer = self._tasks.recv()
        except (EOFError, OSError) as error:
            self._end()
            raise WorkerCrashed(
                "the worker process died during this work; send the request again", exit_code=self._process.exitcode
            ) from error
        if answer.error is not None:
            raise answer.error
        return answer.value

    def kill(self) -> None:
        """End the process from any thread; who waits for its answer gets ``WorkerCrashed``."""
        self._process.kill()

    def close(self) -> None:
        """Let the idle worker leave, then make sure that it is gone."""
        self._tasks.close()
        self._process.join(EXIT_TIMEOUT_S)
        self._end()

    def _end(self) -> None:
        self._process.kill()
        self._process.join()


def _limit_sending(tasks: Connection) -> None:
    """Let sending to a worker that reads nothing end with an error, as waiting for its word does."""
    if sys.platform == "win32":
        return
    with socket.socket(fileno=os.dup(tasks.fileno())) as pipe:
        pipe.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("@ll", TAKE_TIMEOUT_S, 0))
