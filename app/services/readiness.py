"""Whether this server can do its work now, found out in bounded time."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Literal

from app.errors import ScattermarkError
from app.services.bounded import Bounded
from app.services.ports import CpuPool
from app.storage.database import Database
from app.storage.migrate import check_tables
from app.storage.photo_store import PhotoStore

OK = "ok"
# A probe asks every few seconds and waits about five: the answer has to come before, also when a check hangs.
PATIENCE_S = 3.0
SERVING = "serving"

Status = Literal["ready", "degraded", "not ready"]
Check = Callable[[], str | None]  # says what is wrong, or raises


@dataclass(frozen=True)
class ReadinessReport:
    """What was found.

    Attributes
    ----------
    status : str
        ``degraded``: snapshots are located, something else has to wait.
    checks : mapping of str to str
        Each check by name: ``ok``, or what is wrong and what to do.
    """

    status: Status
    checks: Mapping[str, str]

    @property
    def takes_requests(self) -> bool:
        """Whether a load balancer shall send requests here."""
        return self.status != "not ready"


@dataclass(frozen=True)
class Dependencies:
    """What requests depend on.

    Attributes
    ----------
    database : Database
    photos : PhotoStore
    locating : CpuPool
    min_free_bytes : int
        Room on the disk below which uploads are refused.
    live_workers : callable
        How many worker processes stand ready for builds, on whatever machine.
    """

    database: Database
    photos: PhotoStore
    locating: CpuPool
    min_free_bytes: int
    live_workers: Callable[[], int]


class Readiness:
    """Looks at what requests depend on, all at once, for a few seconds at most.

    Without a worker for builds, or with a disk that takes no more photographs, snapshots are located as ever: the
    server is degraded and keeps its place behind the load balancer. Everything else makes it not ready.
    """

    def __init__(self, on: Dependencies) -> None:
        self._needed = _bounded(
            {
                "database": on.database.ping,
                "migrations": partial(check_tables, on.database),
                "photographs": on.photos.check,
                "locate_workers": partial(_locating, on.locating),
            }
        )
        self._wanted = _bounded({"disk": partial(_disk, on), "builds": partial(_builds, on)})

    async def look(self, leaving: bool) -> ReadinessReport:
        """Look at everything; a check without an answer within ``PATIENCE_S`` has failed.

        Parameters
        ----------
        leaving : bool
            Whether the server was told to stop.
        """
        needed, wanted = await asyncio.gather(_answers(self._needed), _answers(self._wanted))
        needed[SERVING] = "the server stops; send requests to another" if leaving else OK
        status: Status = "not ready" if _failed(needed) else "degraded" if _failed(wanted) else "ready"
        return ReadinessReport(status, {**needed, **wanted})


def _bounded(checks: Mapping[str, Check]) -> dict[str, Bounded[str]]:
    return {name: Bounded(partial(_outcome, check), PATIENCE_S) for name, check in checks.items()}


async def _answers(checks: Mapping[str, Bounded[str]]) -> dict[str, str]:
    return dict(zip(checks, await asyncio.gather(*map(_answer, checks.values())), strict=True))


async def _answer(check: Bounded[str]) -> str:
    try:
        return await check.outcome()
    except TimeoutError:
        return f"no answer within {PATIENCE_S:g} s: see whether what it asks is there and can be reached"


def _failed(checks: Mapping[str, str]) -> bool:
    return any(outcome != OK for outcome in checks.values())


def _outcome(check: Check) -> str:
    """What a check says is wrong, or raises; ``ok`` when that is nothing."""
    try:
        return check() or OK
    except ScattermarkError as error:
        return error.detail


def _locating(pool: CpuPool) -> str | None:
    return None if pool.pids else "no worker process is alive: restart the server"


def _disk(on: Dependencies) -> str | None:
    if on.photos.free_bytes() >= on.min_free_bytes:
        return None
    return "less room on the disk than SCATTERMARK_MIN_FREE_BYTES: uploads are refused; `scattermark purge` makes some"


def _builds(on: Dependencies) -> str | None:
    return None if on.live_workers() else "no worker is alive: builds wait until one is; start `scattermark worker`"
