"""What services need from outside, by shape: a pool that does CPU work and a queue that runs builds."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Protocol


class CpuPool(Protocol):
    """Worker processes behind a gate."""

    @property
    def pids(self) -> tuple[int, ...]:
        """Process ids of the living workers."""

    def submit(self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None) -> Future[Any]:
        """Hand a call to the pool; cancelling the future ends the work."""

    async def run(self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None) -> Any:
        """Hand a call to the pool and wait for its result."""


class BuildQueue(Protocol):
    """Whoever runs the builds that wait in the database."""

    def wake(self) -> None:
        """Say that a build waits."""

    def stop(self, job_id: str) -> None:
        """Say that a build was cancelled: what is under way for it shall end."""
