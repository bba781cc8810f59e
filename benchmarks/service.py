"""What ``POST /locate`` costs beside the pipeline itself, and how much of the machine's capacity it reaches.

    python -m benchmarks.service [ROOM] [--requests N] [--memory [N]] [--no-postgres]

A service of its own per database (SQLite, and a Postgres from a wheel) locates one photograph of a room again and again
for 1, 2, 8 and 32 clients, raw and as a form. With one client, requests and calls of the bare pipeline in this process
alternate, so that both meet the same machine; the overhead is the difference of their medians. At saturation, runs of
the service and of a pool alone (same width, same work, no HTTP, no database) alternate; the share is the median of the
pairs' ratios. The service has ``--workers`` processes and a queue for 32.

"CPU ms" is the processor time of a request in the process that answers, beside its workers: unlike the clock it hardly
minds what else the machine does. Clients take processor time too, the last column says how much of it; with few
cores that is taken from the service.

``--memory`` sends 10,000 requests from 8 clients instead, and fits a line to the memory that the processes take.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.cli.room import open_room
from app.jobs.fork_server import start_fork_server
from app.jobs.pool import WorkerPool
from app.services.workers import start_locating
from app.storage.database import Database
from app.storage.migrate import upgrade
from benchmarks.output import print_table, write_json
from benchmarks.own_postgres import own_postgres
from benchmarks.service_clients import OK, Client, Load, Outcome, drive_apart
from benchmarks.service_memory import watch_memory
from benchmarks.service_peers import bare_pipeline, bare_s, pool_per_s, task_of
from benchmarks.service_process import Address, cpu_s, own_service, surveyed_site

OUT = Path(__file__).parent / "out" / "service.json"
CLIENTS = (2, 8, 32)
QUEUE_DEPTH = 32  # so that no client is sent away: refusals are measured by the tests
WARM_UP = 10
PAIRS = 5
MS_PER_S = 1e3
PERCENTILES = (50, 95, 99)
HEADINGS = ("", "p50 ms", "p95 ms", "p99 ms", "over bare ms", "a second", "of pool", "CPU ms", "clients")


@dataclass(frozen=True)
class Stage:
    """A running service, a site of it, and the same work as a task."""

    address: Address
    site_id: str
    photo: Path
    database_url: str
    workers: int
    requests: int

    def load(self, clients: int, *, form: bool) -> Load:
        """Requests for this service."""
        return Load(self.address.port, self.site_id, str(self.photo), form, clients, self.requests)


def main() -> None:
    """Measure on both databases, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("room", nargs="?", type=Path, default=Path("examples/room"))
    parser.add_argument("--photo", default="IMG_0000.jpg", help="of the room's locate folder")
    parser.add_argument("--requests", type=int, default=200, help="of each run")
    parser.add_argument("--workers", type=int, default=max(1, os.cpu_count() or 1))
    parser.add_argument("--memory", nargs="?", type=int, const=10_000, help="requests to watch the memory over")
    parser.add_argument("--no-postgres", action="store_true", help="SQLite alone")
    arguments = parser.parse_args()
    start_fork_server(start_locating.__module__)
    record = {}
    for name, url in _databases(postgres=not arguments.no_postgres):
        with _stage(url, arguments) as stage:
            record[name] = (
                _measure(name, stage) if arguments.memory is None else watch_memory(name, stage, arguments.memory)
            )
    write_json(OUT if arguments.memory is None else OUT.with_stem("service-memory"), record)


def _databases(*, postgres: bool) -> Iterator[tuple[str, str]]:
    """Names and URLs; an empty one is SQLite in the data folder."""
    yield "SQLite", ""
    if postgres:
        with own_postgres() as url:
            yield "Postgres", url


@contextmanager
def _stage(url: str, arguments: argparse.Namespace) -> Iterator[Stage]:
    with ExitStack() as stack:
        data_dir = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="scattermark-bench-")))
        url = url or f"sqlite:///{data_dir / 'scattermark.db'}"
        database = Database(url)
        upgrade(database)
        database.close()
        settings = {
            "SCATTERMARK_DATABASE_URL": url,
            "SCATTERMARK_LOCATE_WORKERS": str(arguments.workers),
            "SCATTERMARK_QUEUE_DEPTH": str(QUEUE_DEPTH),
        }
        room = open_room(arguments.room)
        site_id = surveyed_site(data_dir, settings, room)
        stack.enter_context(bare_pipeline(url, str(data_dir / "photographs")))
        address = stack.enter_context(own_service(data_dir, settings, worker=False))
        photo = room.folder / "locate" / arguments.photo
        yield Stage(address, site_id, photo, url, arguments.workers, arguments.requests)


def _measure(name: str, stage: Stage) -> dict[str, Any]:
    record: dict[str, Any] = {}
    rows = []
    for form in (False, True):
        kind = "form" if form else "raw"
        bare, outcome = _alternate(stage, form=form)
        record[f"{kind}, 1 client"] = {"bare_s": bare, **vars(outcome)}
        rows.append(_row(f"{kind}, 1 client", outcome, statistics.median(bare), None))
        for clients in CLIENTS:
            shares, outcomes = _against_pool(stage, clients, form=form)
            merged = _merged(outcomes)
            record[f"{kind}, {clients} clients"] = {"shares_of_pool": shares, **vars(merged)}
            rows.append(_row(f"{kind}, {clients} clients", merged, statistics.median(bare), statistics.median(shares)))
    bare_ms = MS_PER_S * statistics.median(record["raw, 1 client"]["bare_s"])
    print_table(f"{name}: {stage.workers} workers, bare pipeline {bare_ms:.1f} ms", HEADINGS, rows)
    return record


def _alternate(stage: Stage, *, form: bool) -> tuple[list[float], Outcome]:
    """One client: a call of the bare pipeline, a request, and so on; the first ones fill caches and are left out."""
    task = task_of(stage.database_url, stage.site_id, stage.photo)
    client = Client(stage.load(1, form=form))
    bare, outcome = [], Outcome(statuses={str(OK): stage.requests})
    for turn in range(WARM_UP + stage.requests):
        bare.append(bare_s(task))
        answering_s = cpu_s(stage.address.pid)
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        if client.ask() != OK:
            raise SystemExit("the service did not locate the photograph")
        if turn >= WARM_UP:
            outcome.latencies_s.append(time.perf_counter() - began_s)
            outcome.client_cpu_s += time.process_time() - began_cpu_s
            outcome.service_cpu_s += cpu_s(stage.address.pid) - answering_s
    client.close()
    outcome.duration_s = sum(outcome.latencies_s)
    return bare[WARM_UP:], outcome


def _against_pool(stage: Stage, clients: int, *, form: bool) -> tuple[list[float], list[Outcome]]:
    """Runs of the service and of a pool alone in turns: the machine's pace drifts, their ratio does not."""
    task = task_of(stage.database_url, stage.site_id, stage.photo)
    shares, outcomes = [], []
    with WorkerPool(stage.workers, QUEUE_DEPTH, start_locating, (stage.database_url, tempfile.gettempdir())) as pool:
        pool_per_s(pool, stage.workers, task, WARM_UP)
        for _ in range(PAIRS):
            alone_per_s = pool_per_s(pool, stage.workers, task, stage.requests)
            before_s = cpu_s(stage.address.pid)
            outcomes.append(drive_apart(stage.load(clients, form=form)))
            outcomes[-1].service_cpu_s = cpu_s(stage.address.pid) - before_s
            shares.append(outcomes[-1].per_s / alone_per_s)
    return shares, outcomes


def _merged(outcomes: list[Outcome]) -> Outcome:
    merged = Outcome()
    for outcome in outcomes:
        merged.latencies_s += outcome.latencies_s
        merged.duration_s += outcome.duration_s
        merged.client_cpu_s += outcome.client_cpu_s
        merged.service_cpu_s += outcome.service_cpu_s
        for status, count in outcome.statuses.items():
            merged.statuses[status] = merged.statuses.get(status, 0) + count
    return merged


def _row(name: str, outcome: Outcome, bare_median_s: float, share: float | None) -> tuple[str, ...]:
    percentiles_ms = MS_PER_S * np.percentile(outcome.latencies_s, PERCENTILES)
    cores = os.cpu_count() or 1
    return (
        name,
        *(f"{value:.1f}" for value in percentiles_ms),
        # Where clients wait for each other the difference is mostly their waiting.
        f"{percentiles_ms[0] - MS_PER_S * bare_median_s:.1f}" if share is None else "-",
        f"{outcome.per_s:.1f}",
        "-" if share is None else f"{100 * share:.0f} %",
        f"{MS_PER_S * outcome.service_cpu_s / len(outcome.latencies_s):.1f}",
        f"{100 * outcome.client_cpu_s / outcome.duration_s / cores:.1f} %",
    )


if __name__ == "__main__":
    main()
