"""Pose rows on their way into the database, many to a transaction; who waits hears of it after the commit."""

from __future__ import annotations

import asyncio
import queue
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

from app.errors import ServerFull
from app.storage.database import Database
from app.storage.snapshot_group import Entry, record_snapshots
from app.storage.snapshots import Snapshot

RETRY_AFTER_S = 1


@dataclass(frozen=True)
class GroupOptions:
    """How rows are gathered.

    Attributes
    ----------
    most_rows : int
        In one transaction: Postgres writes 16,000 rows a second by hundreds, 557 one by one (service.md).
    longest_wait_s : float
        A row waits no longer for others: a quarter of what a snapshot's computing takes.
    most_waiting : int
        Rows that may wait while the database stalls; a row takes a few kilobytes. Further ones are refused.
    """

    most_rows: int = 100
    longest_wait_s: float = 0.005
    most_waiting: int = 1000


@dataclass(frozen=True)
class _Waiting:
    entry: Entry
    future: asyncio.Future[Snapshot]


class PoseRecorder:
    """One thread that commits. Rows that come while it does form the next group.

    Parameters
    ----------
    database : Database
    crowded : callable
        Whether snapshots wait for a worker. Only then is it worth a row's while to wait for the next ones: workers have
        enough to do meanwhile. A row that comes alone is committed at once.
    options : GroupOptions
    """

    def __init__(self, database: Database, crowded: Callable[[], bool], options: GroupOptions = GroupOptions()) -> None:
        self._database = database
        self._crowded = crowded
        self._options = options
        self._queue: queue.SimpleQueue[_Waiting | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="pose-recorder", daemon=True)

    def start(self) -> Self:
        """Start the thread."""
        self._thread.start()
        return self

    def close(self) -> None:
        """Commit what waits, then end the thread."""
        self._queue.put(None)
        self._thread.join()

    async def record(self, entry: Entry) -> Snapshot:
        """The snapshot as it was committed; the first one, when its ``snapshot_id`` had come before.

        Raises
        ------
        NotFound, Conflict
            When site or trajectory do not exist, or the trajectory is closed or belongs to another site.
        StorageUnavailable, OutOfSpace
            When the database does not take it.
        ServerFull
            When too many rows wait.
        """
        if not self._thread.is_alive():
            raise RuntimeError("the recorder is not running; call start() first and record nothing after close()")
        if self._queue.qsize() >= self._options.most_waiting:
            raise ServerFull(
                "the database is slow and too many poses wait for it; send the request again",
                retry_after_s=RETRY_AFTER_S,
            )
        future: asyncio.Future[Snapshot] = asyncio.get_running_loop().create_future()
        self._queue.put(_Waiting(entry, future))
        return await future

    def _work(self) -> None:
        while (first := self._queue.get()) is not None:
            group = self._gather(first)
            _settle(group, self._commit(group))

    def _gather(self, first: _Waiting) -> list[_Waiting]:
        group = [first]
        patience_s = self._options.longest_wait_s if self._crowded() else 0.0
        until_s = time.monotonic() + patience_s
        while len(group) < self._options.most_rows:
            try:
                waiting = self._queue.get(timeout=max(0.0, until_s - time.monotonic()))
            except queue.Empty:
                break
            if waiting is None:
                self._queue.put(None)  # the end comes after this group
                break
            group.append(waiting)
        return group

    def _commit(self, group: Sequence[_Waiting]) -> Sequence[Snapshot | Exception]:
        try:
            return record_snapshots(self._database, [waiting.entry for waiting in group])
        except Exception as error:  # noqa: BLE001 - it belongs to those who wait
            return [error] * len(group)


def _settle(group: Sequence[_Waiting], outcomes: Sequence[Snapshot | Exception]) -> None:
    """Tell each event loop once of all that concerns it."""
    by_loop: dict[asyncio.AbstractEventLoop, list[tuple[asyncio.Future[Snapshot], Snapshot | Exception]]]
    by_loop = defaultdict(list)
    for waiting, outcome in zip(group, outcomes, strict=True):
        by_loop[waiting.future.get_loop()].append((waiting.future, outcome))
    for loop, settled in by_loop.items():
        loop.call_soon_threadsafe(_tell, settled)


def _tell(settled: Sequence[tuple[asyncio.Future[Snapshot], Snapshot | Exception]]) -> None:
    for future, outcome in settled:
        if future.done():
            continue  # its client left; the row is there
        if isinstance(outcome, Exception):
            future.set_exception(outcome)
        else:
            future.set_result(outcome)
