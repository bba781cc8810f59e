"""The real service for tests: uvicorn on a free port, worker processes, a folder of its own."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, nullcontext
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import httpx
import uvicorn

from app.api.app import build_api
from app.api.dependencies import Services
from app.api.slow_headers import KEEP_ALIVE_S, PatientProtocol
from app.jobs.supervisor import supervised_worker
from app.main import run_services
from app.settings import PREFIX, Settings

ROOM = Path(__file__).parents[2] / "examples" / "room"
START_S = 180.0  # a process that imports all, and the workers that come of it, on a loaded machine
UNHURRIED_S = 120.0  # for a snapshot, which takes a third of a second when nothing else runs
ANSWER_S = 240.0  # longer than any answer takes
BUILD_S = 300.0
PROBLEM_TYPE = "application/problem+json"
ENDED = ("succeeded", "failed", "cancelled")


@dataclass
class Served:
    """A running service and a client of it."""

    client: httpx.Client
    settings: Settings
    services: Services

    def new_site(self, **body: Any) -> str:
        answer = self.client.post("/sites", json={"name": "room", "code_family": "golay", "plate_u_m": 0.014, **body})
        assert answer.status_code == 201, answer.text
        return str(answer.json()["site_id"])

    def new_survey(self, site_id: str, **body: Any) -> str:
        answer = self.client.post(f"/sites/{site_id}/surveys", json=body)
        assert answer.status_code == 201, answer.text
        return str(answer.json()["survey_id"])

    def put_photo(self, survey_id: str, name: str, data: bytes) -> httpx.Response:
        return self.client.put(f"/surveys/{survey_id}/images/{name}", content=data)

    def put_control_points(self, site_id: str, text: str) -> httpx.Response:
        headers = {"Content-Type": "text/csv"}
        return self.client.put(f"/sites/{site_id}/control-points", content=text, headers=headers)

    def build(self, survey_id: str, **options: Any) -> dict[str, Any]:
        """Start a build and wait for its end."""
        answer = self.client.post(f"/surveys/{survey_id}/build", json=options)
        assert answer.status_code == 202, answer.text
        return self.wait(answer.json()["job_id"])

    def wait(self, job_id: str) -> dict[str, Any]:
        deadline_s = time.monotonic() + BUILD_S
        while time.monotonic() < deadline_s:
            job: dict[str, Any] = self.client.get(f"/jobs/{job_id}").json()
            if job["state"] in ENDED:
                return job
            time.sleep(0.05)
        raise AssertionError(f"the job did not end: {job}")

    def locate(self, site_id: str, image: bytes, **fields: str) -> httpx.Response:
        return self.client.post("/locate", data={"site_id": site_id, **fields}, files={"image": image})


def unhurried(settings: Settings) -> Settings:
    """Time enough for snapshots on a loaded machine, unless the test has set their limit itself."""
    if settings.locate_timeout_s != Settings.locate_timeout_s:
        return settings
    return replace(settings, locate_timeout_s=UNHURRIED_S)


@contextmanager
def hurried(served: Served, limit_s: float) -> Iterator[None]:
    """Give snapshots so many seconds until the block ends."""
    locator = served.services.locator
    before = locator._limits
    locator._limits = replace(before, timeout_s=limit_s)
    try:
        yield
    finally:
        locator._limits = before


def environment_of(settings: Settings) -> dict[str, str]:
    """What gives another process the same settings."""
    return {
        **os.environ,
        **{PREFIX + field.name.upper(): str(getattr(settings, field.name)) for field in fields(settings)},
    }


@contextmanager
def serve(settings: Settings, worker: bool = True) -> Iterator[Served]:
    """Run the service in a thread, and a worker beside it if builds are wanted, until the block ends."""
    settings = unhurried(settings)
    supervised = supervised_worker(settings.data_dir, environment_of(settings)) if worker else nullcontext()
    with supervised, _serve(settings) as served:
        yield served


@contextmanager
def _serve(settings: Settings) -> Iterator[Served]:
    started: list[Services] = []

    @asynccontextmanager
    async def open_services() -> AsyncIterator[Services]:
        async with run_services(settings) as services:
            started.append(services)
            yield services

    app = build_api(settings, open_services)
    config = uvicorn.Config(
        app,
        port=0,
        http=PatientProtocol,
        log_level="error",
        lifespan="on",
        timeout_graceful_shutdown=5,
        timeout_keep_alive=KEEP_ALIVE_S,
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        deadline_s = time.monotonic() + START_S
        while not server.started and thread.is_alive() and time.monotonic() < deadline_s:
            time.sleep(0.01)
        assert server.started, "the service did not start"
        port = server.servers[0].sockets[0].getsockname()[1]
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=ANSWER_S) as client:
            yield Served(client, settings, started[0])
    finally:
        server.should_exit = True
        thread.join()


def assert_problem(answer: httpx.Response, status: int, kind: str) -> dict[str, Any]:
    """The answer is a problem of this kind that says what to do."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == PROBLEM_TYPE
    problem: dict[str, Any] = answer.json()
    assert problem["type"].endswith("/" + kind)
    assert problem["status"] == status
    assert problem["title"]
    assert len(problem["detail"]) > 20
    return problem


def room_photos(folder: str) -> dict[str, bytes]:
    """The demonstration room's photographs by name."""
    return {path.name: path.read_bytes() for path in sorted((ROOM / folder).glob("*.jpg"))}


def room_control_points() -> str:
    return (ROOM / "control_points.csv").read_text()
