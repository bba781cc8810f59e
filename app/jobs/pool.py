"""A pool of worker processes behind a bounded gate: a crash, a hang or a cancel costs one piece of work.

One thread looks after one worker over its own pipe, so nothing is shared that a dying worker could leave locked
(docs/decisions/0001-worker-pool.md compares it with the libraries that were tried).
"""

from __future__ import annotations

import asyncio
import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from types import TracebackType
from typing import Any, Self

from app.jobs.gate import Gate
from app.jobs.keeper import Keeper
from app.jobs.task import Task
from app.jobs.worker import Initializer, WorkerSetup
from app.logs import present_options
from app.services.ports import PoolFigures

CLOSE_GRACE_S = 5.0  # running work may end by itself for so long when the pool closes


class WorkerPool:
    """Runs functions in worker processes, at most ``workers`` at a time and ``queue_depth`` waiting.

    Parameters
    ----------
    workers, queue_depth : int
        Width of the pool and of the queue before it.
    initializer : callable, optional
        Called with ``initargs`` in each worker before it takes work: imports, settings, a first detection.
    initargs : tuple
        Arguments of the initializer.

    Attributes
    ----------
    on_done : callable or None
        Called with each piece of work that a worker did: its function's name, the seconds that it waited for a worker
        and those that it took.
    """

    def __init__(
        self, workers: int, queue_depth: int, initializer: Initializer | None = None, initargs: tuple[Any, ...] = ()
    ) -> None:
        self._gate = Gate(workers, queue_depth)
        self._waiting: queue.SimpleQueue[Task | None] = queue.SimpleQueue()
        setup = WorkerSetup(initializer, initargs, present_options())
        self._keepers = [Keeper(self._waiting, setup) for _ in range(workers)]
        self._in_flight: set[Task] = set()
        self._lock = threading.Lock()
        self._open = False
        self.on_done: Callable[[str, float, float], None] | None = None

    @property
    def figures(self) -> PoolFigures:
        """The pool at this moment."""
        busy = sum(keeper.busy for keeper in self._keepers)
        return PoolFigures(
            workers=len(self.pids),
            busy=busy,
            waiting=max(0, self.in_flight - busy),
            refused=self._gate.refused,
            crashed=sum(keeper.crashed for keeper in self._keepers),
            timed_out=sum(keeper.timed_out for keeper in self._keepers),
            started=sum(keeper.started for keeper in self._keepers),
        )

    @property
    def in_flight(self) -> int:
        """Tasks that run or wait now."""
        return self._gate.in_flight

    @property
    def pids(self) -> tuple[int, ...]:
        """Process ids of the living workers."""
        return tuple(keeper.pid for keeper in self._keepers if keeper.pid is not None)

    def start(self) -> Self:
        """Start the workers and wait until each has finished its initializer.

        Raises
        ------
        WorkerCrashed
            When a worker does not start; none is left behind.
        """
        for keeper in self._keepers:
            keeper.start()
        errors = [error for keeper in self._keepers if (error := keeper.wait_ready()) is not None]
        self._open = True
        if errors:
            self.close()
            raise errors[0]
        return self

    def submit(self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None) -> Task:
        """Hand a call to the pool.

        Parameters
        ----------
        function : callable
            A module's function; it and its arguments must pickle.
        timeout_s : float, optional
            Time limit of the running call; waiting does not count.

        Returns
        -------
        Task
            A future. Its errors: what the call raised, ``TimedOut``, ``WorkerCrashed``, ``Cancelled``.

        Raises
        ------
        ServerFull
            When workers and queue are taken.
        """
        if not self._open:
            raise RuntimeError("the pool is not running; call start() first and submit nothing after close()")
        self._gate.enter()
        task = Task(function, args, timeout_s)
        with self._lock:
            self._in_flight.add(task)
        task.before_settling(lambda: self._count_out(task))
        self._waiting.put(task)
        return task

    async def run(self, function: Callable[..., Any], *args: Any, timeout_s: float | None = None) -> Any:
        """``submit`` for a coroutine.

        When the waiting coroutine is cancelled (its client left), a waiting task is taken back; a running one goes on
        to its end and holds its place in the gate until then, since its worker is really busy.
        """
        loop = asyncio.get_running_loop()
        outcome: asyncio.Future[Any] = loop.create_future()

        def tell(done: Future[Any]) -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(_pass_on, done, outcome)

        task = self.submit(function, *args, timeout_s=timeout_s)
        task.add_done_callback(tell)
        try:
            return await outcome
        except asyncio.CancelledError:
            task.withdraw()
            raise

    def close(self, grace_s: float = CLOSE_GRACE_S) -> None:
        """Take back what waits, give running work ``grace_s`` to finish, end the rest; no process is left."""
        self._open = False
        with self._lock:
            in_flight = tuple(self._in_flight)
        running = [task for task in in_flight if not task.withdraw()]
        wait(running, timeout=grace_s)
        for task in running:
            task.cancel()
        for _ in self._keepers:
            self._waiting.put(None)
        for keeper in self._keepers:
            if keeper.ident is not None:  # it was started
                keeper.join()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _count_out(self, task: Task) -> None:
        with self._lock:
            self._in_flight.discard(task)
        waited_s, running_s = task.waited_s, task.running_s
        self._gate.leave(running_s)
        if self.on_done is not None and waited_s is not None and running_s is not None:
            self.on_done(task.function.__name__, waited_s, running_s)


def _pass_on(done: Future[Any], outcome: asyncio.Future[Any]) -> None:
    """Tell a coroutine, unless it has left, what became of its work: one step of the event loop, no copies."""
    if outcome.done():
        return
    error = done.exception()
    if error is None:
        outcome.set_result(done.result())
    else:
        outcome.set_exception(error)
