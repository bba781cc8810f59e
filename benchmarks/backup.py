"""Backup and restore of a long trajectory: time, file and memory, on SQLite and on Postgres and from one to the other.

    python -m benchmarks.backup [--snapshots N]

Each step runs in a process of its own, so that its greatest memory is its own. Memory that does not grow with the
number of rows is the point: the short and the long run stand side by side. The processor's time is this program's, not
the database server's.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

from sqlalchemy import make_url

from app.services.backup import back_up
from app.services.backup_restore import Target, restore
from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.photo_store import open_photo_store
from app.storage.sites import SiteRepository
from benchmarks.memory import peak_rss_bytes
from benchmarks.output import print_table, write_json
from benchmarks.own_postgres import own_postgres
from benchmarks.trajectory_rows import add_long_trajectory

LONG, SHORT = 1_000_000, 10_000
MEGABYTE = 1e6
MICROSECONDS = 1e6
HEADINGS = ("", "snapshots", "s", "CPU s", "CPU us a row", "file MB", "peak memory MB")
OUT = Path(__file__).parent / "out" / "backup.json"


@dataclass(frozen=True)
class Step:
    """A backup or a restore, measured."""

    name: str
    snapshots: int
    elapsed_s: float
    cpu_s: float
    file_bytes: int
    peak_bytes: int

    def row(self) -> tuple[str, ...]:
        """A line of the table."""
        return (
            self.name,
            f"{self.snapshots:,}",
            f"{self.elapsed_s:.1f}",
            f"{self.cpu_s:.1f}",
            f"{MICROSECONDS * self.cpu_s / self.snapshots:.0f}",
            f"{self.file_bytes / MEGABYTE:.1f}",
            f"{self.peak_bytes / MEGABYTE:.0f}",
        )


def main() -> None:
    """Fill, back up, restore into both, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--snapshots", type=int, default=LONG, help="of the long run")
    long = parser.parse_args().snapshots
    with tempfile.TemporaryDirectory() as folder, own_postgres() as server_url:
        steps = [step for count in (SHORT, long) for step in _measure(Path(folder), server_url, count)]
    print_table("Backup and restore", HEADINGS, [step.row() for step in steps])
    write_json(OUT, {"steps": steps})


def _measure(folder: Path, server_url: str, count: int) -> list[Step]:
    sqlite, postgres = f"sqlite:///{folder / f'{count}.db'}", _new_database(server_url, f"filled_{count}")
    steps = []
    for name, url in (("SQLite", sqlite), ("Postgres", postgres)):
        _fill(url, count)
        steps.append(_alone(f"{name}: backup", count, folder / f"{name}.zip", url, False))
    targets = (f"sqlite:///{folder / f'again-{count}.db'}", _new_database(server_url, f"again_{count}"))
    for name, url in (("Postgres", targets[0]), ("SQLite", targets[1])):
        other = "SQLite" if name == "Postgres" else "Postgres"
        steps.append(_alone(f"{name} to {other}: restore", count, folder / f"{name}.zip", url, True))
    return steps


def _fill(url: str, count: int) -> None:
    database = Database(url)
    upgrade(database)
    with database.writing() as session:
        site_id = SiteRepository(session).add("long", "golay", 0.014, None).site_id
    add_long_trajectory(database, site_id, count)
    database.close()


def _new_database(server_url: str, name: str) -> str:
    server = Database(server_url)
    with server.writer.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.exec_driver_sql(f"CREATE DATABASE {name}")
    server.close()
    return make_url(server_url).set(database=name).render_as_string(hide_password=False)


def _alone(name: str, count: int, file: Path, url: str, restoring: bool) -> Step:
    with get_context("spawn").Pool(1) as pool:
        elapsed_s, cpu_s, peak_bytes = pool.apply(_run, (str(file), url, restoring))
    return Step(name, count, elapsed_s, cpu_s, file.stat().st_size, peak_bytes)


def _run(file: str, url: str, restoring: bool) -> tuple[float, float, int]:
    database = Database(url)
    photos = open_photo_store(f"{file}-photographs")
    begin_s, cpu_begin_s = time.perf_counter(), time.process_time()
    if restoring:
        restore(Path(file), Target(database, photos), _quiet)
    else:
        back_up(database, photos, Path(file), _quiet)
    elapsed_s, cpu_s = time.perf_counter() - begin_s, time.process_time() - cpu_begin_s
    database.close()
    return elapsed_s, cpu_s, peak_rss_bytes()


def _quiet(_stage: str, _done: int, _total: int) -> None:
    """The table tells it."""


if __name__ == "__main__":
    main()
