"""A piece of work on its way through the pool: a future that can be taken back or ended."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from app.errors import Cancelled
from app.logs import log_context


class Task(Future[Any]):
    """One call that a worker process shall make.

    Beside a plain future it can be ended while it runs: ``cancel`` kills the worker that does it. A task that was
    ended or taken back raises ``app.errors.Cancelled`` from ``result``, never ``CancelledError``: the latter would
    read as "the waiting coroutine was cancelled".

    Attributes
    ----------
    function : callable
        A module's function; it travels by name.
    args : tuple
        Its arguments; they travel by pickle.
    timeout_s : float or None
        Time limit of the running call; waiting does not count.
    context : dict
        The ids of the request or job that asked for it: its log lines bear them, whichever process writes them.
    """

    def __init__(self, function: Callable[..., Any], args: tuple[Any, ...], timeout_s: float | None) -> None:
        super().__init__()
        self.function = function
        self.args = args
        self.timeout_s = timeout_s
        self.context = log_context()
        self._submitted_s = time.monotonic()
        self._claim = threading.Lock()  # taken once, by whoever begins the task or takes it back
        self._state_lock = threading.Lock()
        self._end: Callable[[], None] | None = None
        self._end_wanted = False
        self._began_s: float | None = None
        self._settling: Callable[[], None] | None = None

    def before_settling(self, callback: Callable[[], None]) -> None:
        """Call this when the outcome is known, before whoever waits learns of it.

        A future's own callbacks come after: a client that has its answer and sends the next request at once would
        find its place still taken.
        """
        self._settling = callback

    def set_result(self, result: Any) -> None:
        """The outcome, once."""
        self._settle()
        super().set_result(result)

    def set_exception(self, exception: BaseException | None) -> None:
        """The failure, once."""
        self._settle()
        super().set_exception(exception)

    def _settle(self) -> None:
        # Let go of: it knows the task, and a circle that holds a photograph may stand in memory for minutes.
        settling, self._settling = self._settling, None
        if settling is not None:
            settling()

    @property
    def end_wanted(self) -> bool:
        """Whether somebody cancelled the task while it ran."""
        return self._end_wanted

    @property
    def running_s(self) -> float | None:
        """Seconds since a worker took the task; None when none has."""
        return None if self._began_s is None else time.monotonic() - self._began_s

    @property
    def waited_s(self) -> float | None:
        """Seconds until a worker took the task; None when none has."""
        return None if self._began_s is None else self._began_s - self._submitted_s

    def begin(self) -> bool:
        """Claim the task for a worker; False when it was taken back before."""
        if not self._claim.acquire(blocking=False):
            return False
        self._began_s = time.monotonic()
        self.set_running_or_notify_cancel()
        return True

    def withdraw(self) -> bool:
        """Take back a task that still waits; False when it runs or is done."""
        if not self._claim.acquire(blocking=False):
            return False
        self.set_running_or_notify_cancel()
        self.set_exception(Cancelled("the work was taken back before it began"))
        return True

    def cancel(self) -> bool:
        """Take the task back, or end it when it runs; False when it is done."""
        if self.withdraw():
            return True
        with self._state_lock:
            if self.done():
                return False
            self._end_wanted = True
            if self._end is not None:
                self._end()
            return True

    def attach(self, end: Callable[[], None]) -> None:
        """Say how to end the running task; ends it at once when that is already wanted."""
        with self._state_lock:
            self._end = end
            if self._end_wanted:
                end()

    def detach(self) -> None:
        """The worker is no longer busy with this task: ending it must not hit the next one."""
        with self._state_lock:
            self._end = None
