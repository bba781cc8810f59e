"""The worker's side: the loop that runs in a child process."""

from __future__ import annotations

import os
import pickle
import signal
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import connection, parent_process
from multiprocessing.connection import Connection
from typing import Any

import cv2
from threadpoolctl import threadpool_limits

from app.errors import OutOfMemory, ScattermarkError
from app.logs import LogOptions, configure_logs, logging_with

TAKEN = b"taken"
MEMORY_RETRY_S = 5  # other work may have ended by then

Initializer = Callable[..., None]


@dataclass(frozen=True)
class Answer:
    """What a worker sends back: a value, or the error that the call raised."""

    value: Any = None
    error: BaseException | None = None


@dataclass(frozen=True)
class WorkerSetup:
    """What each worker does before its first task; it logs as its parent does."""

    initializer: Initializer | None = None
    initargs: tuple[Any, ...] = ()
    logs: LogOptions | None = None


def work(tasks: Connection, setup: WorkerSetup) -> None:
    """The child's life: set up, say so, then answer one task after the other until the parent's end closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to the parent, which closes the pool in order
    threading.Thread(target=_exit_with_parent, daemon=True).start()
    cv2.setNumThreads(1)  # the pool is the parallelism; more threads only contend
    threadpool_limits(limits=1)
    if setup.logs is not None:
        configure_logs(setup.logs)
    ready = _answer_of(setup.initializer, setup.initargs) if setup.initializer else Answer()
    try:
        _send(tasks, ready)
        while ready.error is None:
            message = tasks.recv_bytes()
            tasks.send_bytes(TAKEN)  # from here on a death is the task's, before it was the idle worker's
            _send(tasks, _answer_of(_call, (message,)))
    except (EOFError, OSError):  # the parent closed its end
        return


def _exit_with_parent() -> None:
    """Leave when the parent dies, even in the middle of a task: a kill -9 must not orphan workers."""
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


def _call(message: bytes) -> Any:
    function, args, context = pickle.loads(message)
    with logging_with(context):
        return function(*args)


def _answer_of(function: Callable[..., Any], args: tuple[Any, ...]) -> Answer:
    try:
        return Answer(value=function(*args))
    except BaseException as error:  # noqa: BLE001 - it is raised again in the parent
        return Answer(error=_portable(error))


def _portable(error: BaseException) -> BaseException:
    """The error itself when it survives the journey, else its text; unexpected ones carry the worker's traceback."""
    if isinstance(error, ScattermarkError):
        return error
    if isinstance(error, MemoryError):
        return OutOfMemory(
            "a worker process had no memory left for this work; send a smaller photograph, or try again later",
            retry_after_s=MEMORY_RETRY_S,
        )
    error.add_note("in the worker:\n" + "".join(traceback.format_exception(error)))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # noqa: BLE001 - whatever a foreign exception's pickling raises
        return RuntimeError("".join(traceback.format_exception(error)))
    return error


def _send(tasks: Connection, answer: Answer) -> None:
    try:
        tasks.send(answer)
    except (pickle.PicklingError, TypeError, AttributeError) as error:  # nothing was written yet
        tasks.send(Answer(error=RuntimeError(f"the result cannot leave the worker: {error}")))
