"""A service of this benchmark's own, with a site to locate in; and how much memory its processes take."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from app.cli.demo_service import without_settings
from app.cli.demo_story import survey_room
from app.cli.room import Room
from app.cli.service_client import ServiceClient

BYTES_PER_MB = 1e6
STOP_S = 30.0
USER_TICKS = 11  # place of utime behind the name in /proc/PID/stat, stime follows (man 5 proc)


@dataclass(frozen=True)
class Address:
    """Where a service answers, and its process."""

    host: str
    port: int
    pid: int

    @property
    def url(self) -> str:
        """For clients that want one."""
        return f"http://{self.host}:{self.port}"


@contextmanager
def own_service(data_dir: Path, settings: Mapping[str, str], *, worker: bool) -> Iterator[Address]:
    """``scattermark serve`` on a free port until the block ends, with or without a worker for builds.

    Raises
    ------
    SystemExit
        When it does not start; its log is in ``data_dir``.
    """
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--data-dir", str(data_dir)]
    environment = {**without_settings(os.environ), "SCATTERMARK_LOG_LEVEL": "warning", **settings}
    with (
        (data_dir / "service.log").open("a") as log,
        subprocess.Popen(
            [*command, *([] if worker else ["--no-worker"])],
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
            env=environment,
        ) as service,
    ):
        try:
            assert service.stdout is not None
            place = urlsplit(next((word for word in service.stdout.readline().split() if word.startswith("http")), ""))
            if place.hostname is None or place.port is None:
                raise SystemExit(f"the service did not start: see {data_dir / 'service.log'}")
            yield Address(place.hostname, place.port, service.pid)
        finally:
            service.terminate()
            service.wait(STOP_S)


def surveyed_site(data_dir: Path, settings: Mapping[str, str], room: Room) -> str:
    """The id of a site with the room's map, built by the service and its worker; both are gone afterwards."""
    with (
        own_service(data_dir, settings, worker=True) as address,
        contextlib.closing(ServiceClient(address.url)) as client,
    ):
        return survey_room(client, room, "golay", lambda _what, _done, _total: None).site_id


@dataclass(frozen=True)
class Memory:
    """Resident memory of a service, MB: of the process that answers, and of the largest of its workers."""

    api_mb: float
    worker_mb: float


def memory_of(pid: int) -> Memory:
    """How much memory a service takes now (Linux).

    Raises
    ------
    OSError
        When it is gone, or where there is no ``/proc``.
    """
    workers = [_resident_mb(child) for child in _descendants(pid)]
    return Memory(_resident_mb(pid), max(workers, default=0.0))


def cpu_s(pid: int) -> float:
    """Processor time that a process has taken so far, without its children (Linux)."""
    fields = (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()
    return sum(int(ticks) for ticks in fields[USER_TICKS : USER_TICKS + 2]) / os.sysconf("SC_CLK_TCK")


def _descendants(pid: int) -> list[int]:
    parents = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            with contextlib.suppress(OSError):  # it ended in this moment
                # After the name, which may hold anything but ends with the last bracket: state, then the parent.
                parents[int(folder.name)] = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
    found, wanted = [], [pid]
    while wanted:
        wanted = [child for child, parent in parents.items() if parent in wanted]
        found += wanted
    return found


def _resident_mb(pid: int) -> float:
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / BYTES_PER_MB
