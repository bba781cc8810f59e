"""What the pool's tests have its workers do: functions of a module, since they travel by name."""

from __future__ import annotations

import os
import time
from pathlib import Path

import cv2
from threadpoolctl import threadpool_info

from app.errors import NotLocated
from app.logs import LogOptions, log_context, present_options

MARKS: list[str] = []


def mark(text: str) -> None:
    MARKS.append(text)


def marks() -> list[str]:
    return MARKS


def double(value: int) -> int:
    return 2 * value


def worker_pid() -> int:
    return os.getpid()


def die() -> None:
    os._exit(3)


def hang() -> None:
    time.sleep(3600)


def start_and_wait_for(started: Path, release: Path) -> str:
    """Say that the work has begun, then go on when told: tests steer by files, not by the clock."""
    started.touch()
    while not release.exists():
        time.sleep(0.005)
    return "released"


def refuse() -> None:
    raise NotLocated("no target was seen; move closer", reason="no-targets", advice="move closer")


class AwkwardError(Exception):
    """An exception that pickles and cannot be built again, as many in the wild."""

    def __init__(self, first: str, second: str) -> None:
        super().__init__(first)
        self.second = second


def raise_awkward() -> None:
    raise AwkwardError("one", "two")


def raise_value_error() -> None:
    raise ValueError("seven is not even")


def unpicklable() -> object:
    return lambda: None


def thread_counts() -> tuple[int, list[int]]:
    import numpy  # noqa: F401 - its BLAS shall be among the libraries listed

    return cv2.getNumThreads(), [library["num_threads"] for library in threadpool_info()]


def fail_to_start() -> None:
    raise RuntimeError("no licence for this worker")


def logs_with() -> tuple[dict[str, object], LogOptions | None]:
    """What this worker's log lines would bear, and how it logs."""
    return log_context(), present_options()
