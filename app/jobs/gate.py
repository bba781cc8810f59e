"""The gate before the pool: how much work may be under way, and when to come back once it is full."""

from __future__ import annotations

import math
import threading

from app.errors import ServerFull

FIRST_GUESS_S = 0.1  # duration of a piece of work before one has been seen: a snapshot takes tens of milliseconds
SMOOTHING = 0.2  # weight of the newest duration in the running mean: follows a change of load within ten pieces


class Gate:
    """A bounded count of pieces of work in flight.

    Parameters
    ----------
    workers : int
        Pieces of work that run at a time.
    queue_depth : int
        Pieces of work that may wait beside the running ones.
    """

    def __init__(self, workers: int, queue_depth: int) -> None:
        if workers < 1 or queue_depth < 0:
            raise ValueError(f"at least one worker and no negative queue, got {workers} and {queue_depth}")
        self._workers = workers
        self._capacity = workers + queue_depth
        self._in_flight = 0
        self._refused = 0
        self._mean_s = FIRST_GUESS_S
        self._lock = threading.Lock()

    @property
    def in_flight(self) -> int:
        """Pieces of work that run or wait now."""
        return self._in_flight

    @property
    def refused(self) -> int:
        """Pieces of work that were not let in, ever."""
        return self._refused

    @property
    def retry_after_s(self) -> int:
        """Whole seconds, at least one, in which the present queue drains at the present pace."""
        return max(1, math.ceil(self._mean_s * self._capacity / self._workers))

    def enter(self) -> None:
        """Let one piece of work in.

        Raises
        ------
        ServerFull
            When workers and queue are taken; ``fields['retry_after_s']`` says when to come back.
        """
        with self._lock:
            if self._in_flight >= self._capacity:
                self._refused += 1
                raise ServerFull(
                    f"all {self._workers} workers are busy and the queue is full; "
                    f"send the request again in {self.retry_after_s} s",
                    retry_after_s=self.retry_after_s,
                )
            self._in_flight += 1

    def leave(self, duration_s: float | None) -> None:
        """Count one piece of work out; ``duration_s`` is how long it ran, None when it never began."""
        with self._lock:
            self._in_flight -= 1
            if duration_s is not None:
                self._mean_s += SMOOTHING * (duration_s - self._mean_s)
