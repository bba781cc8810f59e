"""Builds by workers: what the engine adds, and when work goes on after a kill -9: ``python -m benchmarks.builds``.

On SQLite one worker, killed and started again; on Postgres two, of which the one that has the build is killed. Each
build is set beside the same detection and adjustment without service, engine and database, in the same run.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import select

from app.cli.demo_service import without_settings
from app.cli.detect_file import detect_file
from app.cli.room import Room, open_room
from app.cli.service_client import ServiceClient
from app.jobs.pool import WorkerPool
from app.photogrammetry.survey import PlateSpec, SurveyPhoto, adjust_survey
from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.models import DetectionRow, JobRow, WorkerRow
from app.vision.detectors import choose_detector
from benchmarks.own_postgres import own_postgres
from benchmarks.service_process import own_service

WAIT_S = 300.0
LOOK_S = 0.02
IDLE_S = 10.0
KB_PER_MB = 1000.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class Figures:
    """What was measured on one database; seconds unless the name says otherwise."""

    start_s: float
    memory_mb: float
    idle_percent: float
    bare_s: float
    build_s: float
    rebuild_s: float
    goes_on_s: float
    photographs_twice: int


@dataclass(frozen=True)
class Bench:
    """A service with a survey, and the workers over it."""

    client: ServiceClient
    database: Database
    survey_id: str
    start_worker: Callable[[], subprocess.Popen[str]]

    def build(self, strictness: str) -> str:
        """Ask for a build; its id."""
        self.client.close()  # as in job
        return str(self.client.post("surveys", self.survey_id, "build", body={"strictness": strictness})["job_id"])

    def seconds_until(self, condition: Callable[[], bool]) -> float:
        """How long it takes."""
        began_s = time.monotonic()
        while not condition():
            if time.monotonic() - began_s > WAIT_S:
                raise SystemExit("a build did not get on")
            time.sleep(LOOK_S)
        return time.monotonic() - began_s

    def job(self, job_id: str) -> dict[str, Any]:
        """How far a build is."""
        self.client.close()  # the service hangs up on who is silent for some seconds; the next call connects anew
        answer: dict[str, Any] = self.client.get("jobs", job_id)
        return answer

    def ended(self, job_id: str) -> bool:
        """Whether a build has ended; well, or not at all."""
        job = self.job(job_id)
        if job["state"] == "failed":
            raise SystemExit(f"a build failed: {job['error']['detail']}")
        return bool(job["state"] == "succeeded")

    def one(self, column: object, *where: object) -> object:
        """A value of the database."""
        with self.database.reading() as session:
            return session.scalar(select(column).where(*where))  # type: ignore[call-overload]


def main() -> int:
    """Measure on both databases, print."""
    parser = argparse.ArgumentParser(description="Builds by workers: overhead, and the time until work goes on.")
    parser.add_argument("room", type=Path, nargs="?", default=Path("examples/room"))
    room = open_room(parser.parse_args().room, None)
    with tempfile.TemporaryDirectory() as folder:
        print(json.dumps({"sqlite": asdict(measure(room, Path(folder), ""))}, indent=1), flush=True)
    with tempfile.TemporaryDirectory() as folder, own_postgres() as url:
        upgrade(Database(url))
        print(json.dumps({"postgresql": asdict(measure(room, Path(folder), url))}, indent=1))
    return 0


def measure(room: Room, folder: Path, url: str) -> Figures:
    """All figures of one database."""
    settings = {"SCATTERMARK_DATABASE_URL": url} if url else {}
    with prepared(room, folder, settings) as bench:
        began_s = time.monotonic()
        worker = bench.start_worker()
        start_s = time.monotonic() - began_s
        bare_s = bare(room)
        job_id = bench.build("strict")
        build_s = bench.seconds_until(lambda: bench.ended(job_id))
        again_id = bench.build("strict")
        rebuild_s = bench.seconds_until(lambda: bench.ended(again_id))
        idle = idle_percent(worker.pid)
        memory_mb = resident_mb(worker.pid)
        goes_on_s, twice = killed(bench, worker, others=1 if url else 0)
    return Figures(start_s, memory_mb, idle, bare_s, build_s, rebuild_s, goes_on_s, twice)


def killed(bench: Bench, worker: subprocess.Popen[str], others: int) -> tuple[float, int]:
    """Seconds from the death of the worker that has a build until it goes on, and photographs detected twice."""
    workers = [worker, *(bench.start_worker() for _ in range(others))]
    job_id = bench.build("eager")
    bench.seconds_until(lambda: bench.job(job_id)["done"] > 0)
    owner = bench.one(JobRow.owner, JobRow.id == job_id)
    with bench.database.reading() as session:
        signed_up = list(session.scalars(select(WorkerRow.id).order_by(WorkerRow.id)))
        before = set(session.execute(select(DetectionRow.sha256, DetectionRow.options_digest, DetectionRow.created_s)))
    workers[signed_up.index(str(owner))].send_signal(signal.SIGKILL)
    began_s = time.monotonic()
    if not others:
        bench.start_worker()
    bench.seconds_until(lambda: bench.one(JobRow.owner, JobRow.id == job_id) not in (owner, None))
    goes_on_s = time.monotonic() - began_s
    bench.seconds_until(lambda: bench.ended(job_id))
    with bench.database.reading() as session:
        after = set(session.execute(select(DetectionRow.sha256, DetectionRow.options_digest, DetectionRow.created_s)))
    return goes_on_s, len(before - after)


def bare(room: Room) -> float:
    """Seconds for the same detection and adjustment by a warm pool alone: the second of two times."""
    detector = choose_detector("default", "strict")
    with WorkerPool(os.cpu_count() or 1, len(room.survey)) as pool:
        for _ in range(2):
            began_s = time.monotonic()
            tasks = [pool.submit(detect_file, path, "golay", detector) for path in room.survey]
            pool.submit(adjust, [task.result() for task in tasks], room.plate_u_m).result()
    return time.monotonic() - began_s


def adjust(photos: list[SurveyPhoto], plate_u_m: float) -> int:
    """Adjust in a process of the pool; how many targets."""
    return len(adjust_survey(photos, (), PlateSpec("golay", plate_u_m)).target_map.targets)


@contextmanager
def prepared(room: Room, folder: Path, settings: Mapping[str, str]) -> Iterator[Bench]:
    """A service without a worker, and a survey of the room."""
    with ExitStack() as until:
        address = until.enter_context(own_service(folder, settings, worker=False))
        client = until.enter_context(contextlib.closing(ServiceClient(address.url)))
        site = {"name": "room", "code_family": "golay", "plate_u_m": room.plate_u_m}
        site_id = client.post("sites", body=site)["site_id"]
        survey_id = client.post("sites", site_id, "surveys", body={})["survey_id"]
        for photo in room.survey:
            kind = "application/octet-stream"
            client.put("surveys", survey_id, "images", photo.name, data=photo.read_bytes(), kind=kind)

        def start_worker() -> subprocess.Popen[str]:
            environment = {**without_settings(os.environ), "SCATTERMARK_LOG_LEVEL": "error", **settings}
            command = [sys.executable, "-m", "app.cli", "worker", "--data-dir", str(folder)]
            worker = until.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment))
            until.callback(worker.terminate)
            assert worker.stdout is not None
            worker.stdout.readline()
            return worker

        url = settings.get("SCATTERMARK_DATABASE_URL") or f"sqlite:///{folder / 'scattermark.db'}"
        yield Bench(client, Database(url), survey_id, start_worker)


def resident_mb(pid: int) -> float:
    """Memory of the worker itself, without its pool."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(float(line.split()[1]) / KB_PER_MB for line in lines if line.startswith("VmRSS"))


def idle_percent(pid: int) -> float:
    """Share of one core that a worker without work takes."""
    before = ticks(pid)
    time.sleep(IDLE_S)
    return 100.0 * (ticks(pid) - before) / TICKS_PER_S / IDLE_S


def ticks(pid: int) -> int:
    """Clock ticks that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


if __name__ == "__main__":
    sys.exit(main())
