"""A call that may hang, asked with patience of its own: what hangs must not hang who looks after it."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

Outcome = TypeVar("Outcome")


class Bounded(Generic[Outcome]):
    """Runs a function in a thread of its own, one call at a time; whoever asks meanwhile shares that call.

    A call that hangs holds one thread, however often it is asked for, and none that requests need. The thread does not
    keep the process from ending.

    Parameters
    ----------
    function : callable
        Gives the outcome.
    patience_s : float
        How long is waited for it.
    """

    def __init__(self, function: Callable[[], Outcome], patience_s: float) -> None:
        self._function = function
        self._patience_s = patience_s
        self._lock = threading.Lock()
        self._under_way: Future[Outcome] | None = None

    def ask(self) -> Outcome:
        """The outcome.

        Raises
        ------
        TimeoutError
            When it took too long; the call goes on and whoever asks next may get its outcome.
        Exception
            What the function raised.
        """
        return self._begun().result(self._patience_s)

    async def outcome(self) -> Outcome:
        """``ask`` for a coroutine."""
        call = asyncio.wrap_future(self._begun())
        async with asyncio.timeout(self._patience_s):
            return await asyncio.shield(call)

    def _begun(self) -> Future[Outcome]:
        with self._lock:
            if self._under_way is None or self._under_way.done():
                self._under_way = Future()
                threading.Thread(target=self._run, args=(self._under_way,), daemon=True).start()
            return self._under_way

    def _run(self, call: Future[Outcome]) -> None:
        try:
            call.set_result(self._function())
        except BaseException as error:  # noqa: BLE001 - it belongs to whoever asked
            call.set_exception(error)
