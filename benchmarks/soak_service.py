"""A service over many requests and over its capacity: flat memory, honest refusals, alive at the end."""

from __future__ import annotations

import statistics
import time
from dataclasses import replace
from typing import Protocol

import httpx

from benchmarks.output import print_table
from benchmarks.service_clients import FULL, OK, Load, drive_apart
from benchmarks.service_memory import Growth, growth, watch_memory
from benchmarks.service_process import Address, Memory, memory_of

FLAT_MB_PER_1000 = 1.0  # a leak of one snapshot's pixels in a thousand would be 2.8
LEAST_ROUNDS = 8
ROUND_S = 15.0
CAPACITY_REQUESTS = 200
ROUNDS_PER_LOOK = 4  # after so many rounds the capacity is measured again, as the machine's pace drifts
LEAST_OFFER = 2.0  # times the capacity
LEAST_SERVED = 0.7  # of the capacity while refusals cost time too
CLIENTS_PER_PLACE = 4  # clients for each place in the gate: most are sent away and come again at once
PER = 1000
HEADINGS = ("", "")


class Stage(Protocol):
    """A running service with a site."""

    @property
    def address(self) -> Address:
        """Where it answers."""

    @property
    def workers(self) -> int:
        """How many locate."""

    @property
    def places(self) -> int:
        """How many snapshots it takes in at a time."""

    def load(self, clients: int, *, form: bool) -> Load:
        """Requests for it."""


def soak_memory(stage: Stage, requests: int) -> list[str]:
    """Watch the memory over so many requests; what failed."""
    lines: dict[str, Growth] = watch_memory("SQLite", stage, requests)["lines"]
    return [
        f"the {which} grows by {line.slope_mb_per_1000:.2f} MB per 1000 requests"
        for which, line in lines.items()
        if line.slope_mb_per_1000 > FLAT_MB_PER_1000
    ]


def soak_overload(stage: Stage, minutes: float) -> list[str]:
    """Offer more than twice the capacity for so long; what failed."""
    alone = replace(stage.load(stage.workers, form=False), requests=CAPACITY_REQUESTS)
    capacities_per_s = [drive_apart(alone).per_s]
    load = stage.load(CLIENTS_PER_PLACE * stage.places, form=False)
    load = replace(load, requests=int(LEAST_OFFER * capacities_per_s[0] * ROUND_S))
    served, offered, spent_s, failures = 0, 0, 0.0, list[str]()
    memory: list[tuple[int, Memory]] = []
    deadline_s = time.monotonic() + 60.0 * minutes
    while time.monotonic() < deadline_s or len(memory) < LEAST_ROUNDS:
        outcome = drive_apart(load)
        served, spent_s = served + len(outcome.latencies_s), spent_s + outcome.duration_s
        offered += sum(outcome.statuses.values())
        memory.append((offered, memory_of(stage.address.pid)))
        failures += _alive(stage.address, outcome.statuses)
        if len(memory) % ROUNDS_PER_LOOK == 0:
            capacities_per_s.append(drive_apart(alone).per_s)
    capacity_per_s = statistics.median(capacities_per_s)
    rows = [
        ("capacity, snapshots/s", f"{capacity_per_s:.1f}"),
        ("offered a second, times the capacity", f"{offered / spent_s / capacity_per_s:.2f}"),
        ("served a second, of the capacity", f"{served / spent_s / capacity_per_s:.2f}"),
        ("requests", str(offered)),
        ("memory at first and at last, MB", f"{memory[0][1].api_mb:.0f} {memory[-1][1].api_mb:.0f}"),
    ]
    print_table(f"{spent_s / 60:.1f} minutes over capacity", HEADINGS, rows)
    return failures + _judged(capacity_per_s, offered / spent_s, served / spent_s, memory)


def _alive(address: Address, statuses: dict[str, int]) -> list[str]:
    """Whether it answers and did what it should."""
    odd = {status: count for status, count in statuses.items() if int(status) not in (OK, FULL)}
    failures = [f"answers of status {odd}"] if odd else []
    if httpx.get(f"{address.url}/healthz").status_code != OK:
        failures.append("the service does not answer /healthz")
    return failures


def _judged(
    capacity_per_s: float, offered_per_s: float, served_per_s: float, memory: list[tuple[int, Memory]]
) -> list[str]:
    failures = []
    if offered_per_s < LEAST_OFFER * capacity_per_s:
        failures.append(f"only {offered_per_s / capacity_per_s:.1f} times the capacity was offered")
    if served_per_s < LEAST_SERVED * capacity_per_s:
        failures.append(f"only {served_per_s / capacity_per_s:.0%} of the capacity was served")
    slope = growth(memory, lambda sample: sample.api_mb).slope_mb_per_1000
    if slope > FLAT_MB_PER_1000:
        failures.append(f"the process that answers grows by {slope:.2f} MB per {PER} requests")
    return failures
