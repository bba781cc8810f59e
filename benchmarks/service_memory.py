"""The memory of a service over many requests: a line fitted to what its processes take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from benchmarks.output import print_table
from benchmarks.service_clients import Load, drive_apart
from benchmarks.service_process import Address, Memory, memory_of

CLIENTS = 8
ROUNDS = 40  # samples: the memory is read between rounds
SETTLED_SHARE = 0.25  # of the rounds come before caches are full and allocators have taken what they need
PER = 1000  # requests
HEADINGS = ("", "at first MB", "at last MB", "MB per 1000 requests")


class Stage(Protocol):
    """A running service with a site."""

    @property
    def address(self) -> Address:
        """Where it answers."""

    def load(self, clients: int, *, form: bool) -> Load:
        """Requests for it."""


@dataclass(frozen=True)
class Growth:
    """A line through the memory of a process after it has settled."""

    first_mb: float
    last_mb: float
    slope_mb_per_1000: float


def memory_over(pid: int, ask: Callable[[int], None], requests: int, rounds: int) -> list[tuple[int, Memory]]:
    """Memory after each of some rounds of requests, with the number of requests so far; ``ask`` sends so many."""
    samples = []
    for number in range(1, rounds + 1):
        ask(requests // rounds)
        samples.append((number * (requests // rounds), memory_of(pid)))
    return samples


def growth(samples: list[tuple[int, Memory]], of: Callable[[Memory], float]) -> Growth:
    """How the memory grows once it has settled."""
    settled = samples[int(len(samples) * SETTLED_SHARE) :]
    counts, sizes_mb = np.array([count for count, _ in settled]), np.array([of(memory) for _, memory in settled])
    slope, _ = np.polyfit(counts / PER, sizes_mb, 1)
    return Growth(float(sizes_mb[0]), float(sizes_mb[-1]), float(slope))


def watch_memory(name: str, stage: Stage, requests: int) -> dict[str, Any]:
    """Send so many requests, half of them as forms, and say what became of the memory."""
    turns = iter(range(ROUNDS))

    def ask(count: int) -> None:
        drive_apart(replace(stage.load(CLIENTS, form=next(turns) % 2 == 1), requests=count))

    samples = memory_over(stage.address.pid, ask, requests, ROUNDS)
    lines = {
        "process that answers": growth(samples, lambda memory: memory.api_mb),
        "largest worker": growth(samples, lambda memory: memory.worker_mb),
    }
    rows = [
        (which, f"{line.first_mb:.1f}", f"{line.last_mb:.1f}", f"{line.slope_mb_per_1000:+.3f}")
        for which, line in lines.items()
    ]
    print_table(f"{name}: memory over {requests} requests", HEADINGS, rows)
    return {"samples": samples, "lines": lines}
