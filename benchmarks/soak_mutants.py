"""Malformed images through the pool, and a share of them over HTTP: located or refused, nothing else."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

import httpx

from app.errors import BadPhoto, PhotoTooLarge, ScattermarkError, TimedOut, UnsupportedPhoto
from app.jobs.pool import WorkerPool
from app.services.locate_work import LocateOutcome, LocateTask, locate_photo
from app.services.workers import start_locating
from benchmarks.mutants import mutants, seeds
from benchmarks.output import console, print_table
from benchmarks.service_peers import task_of
from benchmarks.service_process import Address

HTTP_SHARE = 100  # every how-manieth goes over HTTP too
ANSWERS = (200, 413, 415, 422)  # a snapshot's pose, or one of its refusals
REFUSALS = (BadPhoto, UnsupportedPhoto, PhotoTooLarge)
TIME_LIMIT_S = 10.0  # the service's own for a snapshot
WAITING_PER_WORKER = 4
HTTP_TIMEOUT_S = 60.0


class Stage(Protocol):
    """A running service with a site."""

    @property
    def address(self) -> Address:
        """Where it answers."""

    @property
    def site_id(self) -> str:
        """A site with a map."""

    @property
    def photo(self) -> Path:
        """A photograph that can be located in it."""

    @property
    def data_dir(self) -> Path:
        """Its folder."""

    @property
    def database_url(self) -> str:
        """Its database."""

    @property
    def workers(self) -> int:
        """How many locate."""


@dataclass
class _Tally:
    """What became of the images, and what should not have."""

    folder: Path
    outcomes: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    def note_fault(self, data: bytes, what: str) -> None:
        """Keep an image that broke something."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / hashlib.sha256(data).hexdigest()[:16]
        path.write_bytes(data)
        self.faults.append(f"{what}: {path}")


def soak_mutants(stage: Stage, seed: int, count: int, folder: Path) -> list[str]:
    """Send so many malformed images; what failed."""
    tally = _Tally(folder)
    task = task_of(stage.database_url, stage.site_id, stage.photo)
    pictures = mutants(seeds(stage.photo.read_bytes()), seed, count)
    begin = stage.database_url, str(stage.data_dir / "photographs")
    waiting = stage.workers * WAITING_PER_WORKER
    with (
        WorkerPool(stage.workers, waiting, start_locating, begin) as pool,
        httpx.Client(base_url=stage.address.url, timeout=HTTP_TIMEOUT_S) as client,
    ):
        for number, data in enumerate(_through(pool, task, waiting, pictures, tally)):
            if number % HTTP_SHARE == 0:
                _send(client, stage.site_id, data, tally)
    rows = [(name, str(number)) for name, number in tally.outcomes.most_common()]
    print_table(f"{count} malformed images, seed {seed}", ("", "images"), rows)
    return tally.faults


def _through(
    pool: WorkerPool, task: LocateTask, waiting: int, pictures: Iterator[bytes], tally: _Tally
) -> Iterator[bytes]:
    """Have the pool look at all pictures, and give each on once it has."""
    running: dict[Future[LocateOutcome], bytes] = {}
    for data in pictures:
        running[pool.submit(locate_photo, replace(task, photo=data), timeout_s=TIME_LIMIT_S)] = data
        if len(running) >= waiting:
            yield from _settled(running, tally)
    while running:
        yield from _settled(running, tally)


def _settled(running: dict[Future[LocateOutcome], bytes], tally: _Tally) -> Iterator[bytes]:
    done, _ = wait(running, return_when=FIRST_COMPLETED)
    for future in done:
        data = running.pop(future)
        error = future.exception()
        if error is None:
            tally.outcomes[f"decoded: {type(future.result().outcome).__name__}"] += 1
        elif isinstance(error, REFUSALS):
            tally.outcomes[f"refused: {error.slug}"] += 1
        else:
            kind = error.slug if isinstance(error, ScattermarkError) else type(error).__name__
            tally.outcomes[f"FAULT: {kind}"] += 1
            tally.note_fault(data, f"{kind} after {TIME_LIMIT_S:g} s" if isinstance(error, TimedOut) else f"{error!r}")
        yield data


def _send(client: httpx.Client, site_id: str, data: bytes, tally: _Tally) -> None:
    status = client.post("/locate", params={"site_id": site_id}, content=data).status_code
    tally.outcomes[f"over HTTP: {status}"] += 1
    if status not in ANSWERS:
        tally.note_fault(data, f"over HTTP {status}")
        console.print(f"over HTTP {status}")
