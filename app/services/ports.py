"""What services need from outside, by shape: a pool that does CPU work."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class PoolFigures:
    """A pool at this moment.

    Attributes
    ----------
    workers, busy, waiting : int
        Living worker processes, those of them at work, and pieces of work that wait for one.
    refused, crashed, timed_out, started : int
        Ever: pieces of work that were not let in, that a worker died of, that outlasted their time limit; and worker
        processes that were started.
    """

    workers: int
    busy: int
    waiting: int
    refused: int
    crashed: int
    timed_out: int
    started: int


class CpuPool(Protocol):
    """Worker processes behind a gate.

    Attributes
    ----------
    on_done : callable or None
        Called with each piece of work that a worker did: its function's name, the seconds that it waited for a worker
        and those that it took.
    """

    on_done: Callable[[str, float, float], None] | None

    @property
    def figures(self) -> PoolFigures:
        """The pool at this moment."""

    @property
    def pids(self) -> tuple[int, ...]:
        """Process ids of the living workers."""

    def submit(self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None) -> Future[Any]:
        """Hand a call to the pool; cancelling the future ends the work."""

    async def run(self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None) -> Any:
        """Hand a call to the pool and wait for its result."""
