"""What is under way in the pool for each attempt at a job, so that it can be ended with it."""

from __future__ import annotations

import threading
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any

from app.storage.jobs import JobRun


class BuildTasks:
    """Futures by attempt; from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._futures: defaultdict[JobRun, set[Future[Any]]] = defaultdict(set)

    @property
    def runs(self) -> frozenset[JobRun]:
        """Attempts for which something is under way."""
        with self._lock:
            return frozenset(self._futures)

    @contextmanager
    def watching(self, run: JobRun, future: Future[Any]) -> Iterator[None]:
        """Have the future ended with the attempt while the block lasts."""
        with self._lock:
            self._futures[run].add(future)
        try:
            yield
        finally:
            with self._lock:
                self._futures[run].discard(future)
                if not self._futures[run]:
                    del self._futures[run]

    def end(self, run: JobRun) -> None:
        """End what is under way for an attempt: its futures raise ``Cancelled``."""
        with self._lock:
            futures = tuple(self._futures.get(run, ()))
        for future in futures:
            future.cancel()
