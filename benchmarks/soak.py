"""Hours of ill-treatment in one command: malformed images, memory, twice the load that the service can carry.

    python -m benchmarks.soak [ROOM] [--mutants N] [--requests N] [--minutes M] [--seed S]

1. Malformed images from a seed (``benchmarks/mutants.py``) through the worker pool, every hundredth over HTTP: each is
   located or refused. A worker that dies, hangs or raises anything else is a fault; its image is kept.
2. Clients that offer more than twice what the service can carry: it answers what it can, sends the others away, stays
   alive, and takes no more memory at the end than at the beginning.
3. Requests with the memory of the service watched: after the load its allocators have taken what they need.

The last line is the verdict; the exit code is 1 when any part failed.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from app.cli.room import Room, open_room
from app.jobs.fork_server import start_fork_server
from app.services.workers import start_locating
from benchmarks.output import console
from benchmarks.service_clients import Load
from benchmarks.service_process import Address, own_service, surveyed_site
from benchmarks.soak_mutants import soak_mutants
from benchmarks.soak_service import soak_memory, soak_overload

PHOTO = "IMG_0000.jpg"
QUEUE_DEPTH = 8  # the default: a queue that is soon full
FAULTS = Path(__file__).parent / "out" / "faults"


@dataclass(frozen=True)
class Stage:
    """A running service with a site, its folder, and how many workers it has."""

    address: Address
    site_id: str
    photo: Path
    data_dir: Path
    workers: int

    @property
    def places(self) -> int:
        """How many snapshots it takes in at a time."""
        return self.workers + QUEUE_DEPTH

    @property
    def database_url(self) -> str:
        """Of the file that the service looks after."""
        return f"sqlite:///{self.data_dir / 'scattermark.db'}"

    def load(self, clients: int, *, form: bool) -> Load:
        """Requests for this service."""
        return Load(self.address.port, self.site_id, str(self.photo), form, clients, requests=0)


def main() -> int:
    """Run the three parts, print, say the verdict."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("room", nargs="?", type=Path, default=Path("examples/room"))
    parser.add_argument("--mutants", type=int, default=100_000, help="malformed images (100,000)")
    parser.add_argument("--requests", type=int, default=10_000, help="requests with memory watched (10,000)")
    parser.add_argument("--minutes", type=float, default=60.0, help="time at twice the capacity (60)")
    parser.add_argument("--seed", type=int, default=1, help="of the malformed images (1)")
    arguments = parser.parse_args()
    start_fork_server(start_locating.__module__)
    workers = max(1, os.cpu_count() or 1)
    with _stage(open_room(arguments.room), workers) as stage:
        failures = [
            *soak_mutants(stage, arguments.seed, arguments.mutants, FAULTS),
            *soak_overload(stage, arguments.minutes),
            *soak_memory(stage, arguments.requests),
        ]
    for failure in failures:
        console.print(f"FAILED: {failure}")
    console.print("soak: " + (f"{len(failures)} failures" if failures else "all held"))
    return 1 if failures else 0


@contextmanager
def _stage(room: Room, workers: int) -> Iterator[Stage]:
    with tempfile.TemporaryDirectory(prefix="scattermark-soak-") as folder:
        data_dir = Path(folder)
        settings = {"SCATTERMARK_LOCATE_WORKERS": str(workers), "SCATTERMARK_QUEUE_DEPTH": str(QUEUE_DEPTH)}
        site_id = surveyed_site(data_dir, settings, room)
        with own_service(data_dir, settings, worker=False) as address:
            yield Stage(address, site_id, room.folder / "locate" / PHOTO, data_dir, workers)


if __name__ == "__main__":
    raise SystemExit(main())
