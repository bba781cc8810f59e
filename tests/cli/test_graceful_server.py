"""The service told to stop: what it has begun is answered, watchers are let go, no process stays, it ends with 0."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from PIL import Image
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from app.cli.demo_service import without_settings
from app.storage.database import Database
from app.storage.surveys import SurveyRepository
from app.storage.target_maps import TargetMapRepository
from tests.api.metrics_reading import Scrape
from tests.jobs.test_pool import is_gone
from tests.storage.examples import publication

WAIT_S = 180.0  # for a machine that is busy with other things
SERVICE_RESTART = 1012  # IANA's registry of WebSocket close codes
SIGTERM_EXIT = 143  # the shell's number for it
PHOTO_PX = (1200, 800)


@dataclass
class Running:
    """``scattermark serve`` in a process of its own."""

    process: subprocess.Popen[str]
    client: httpx.Client
    log: Path

    def stream_url(self, site_id: str) -> str:
        """Of the WebSocket that takes snapshots."""
        return f"ws://{self.client.base_url.netloc.decode()}/locate/stream?site_id={site_id}"

    def events(self) -> list[dict[str, object]]:
        return [json.loads(line) for line in self.log.read_text().splitlines()]

    def children(self) -> set[int]:
        """The process ids of all that it has started, and of what those have."""
        found: set[int] = set()
        for parent in (pids := [self.process.pid]):
            try:
                lists = [path.read_text() for path in Path(f"/proc/{parent}/task").glob("*/children")]
            except FileNotFoundError:
                continue
            pids.extend(int(pid) for text in lists for pid in text.split())
            found.update(pids[1:])
        return found


@contextmanager
def serving(folder: Path, *options: str, **settings: str) -> Iterator[Running]:
    environment = without_settings(os.environ) | {"SCATTERMARK_LOCATE_WORKERS": "1", "SCATTERMARK_BUILD_WORKERS": "1"}
    environment |= {f"SCATTERMARK_{name}": value for name, value in settings.items()}
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--data-dir", str(folder), *options]
    log = folder / "log"
    with (
        log.open("w") as errors,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True, env=environment) as process,
    ):
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert "http" in line, log.read_text()
            with httpx.Client(base_url=line.split()[-1], timeout=WAIT_S) as client:
                yield Running(process, client, log)
        finally:
            process.kill()


def until(condition: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < deadline_s, "what the test waits for did not happen"
        time.sleep(0.01)


def blank_photo() -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", PHOTO_PX, (90, 100, 110)).save(buffer, "PNG")
    return buffer.getvalue()


def new_site(running: Running) -> str:
    body = {"name": "room", "code_family": "golay", "plate_u_m": 0.014}
    return str(running.client.post("/sites", json=body).json()["site_id"])


class Watcher(threading.Thread):
    """Reads a stream of events to its end."""

    def __init__(self, client: httpx.Client, path: str) -> None:
        super().__init__(daemon=True)
        self._client, self._path = client, path
        self.started = threading.Event()
        self.fault: Exception | None = None

    def run(self) -> None:
        try:
            with self._client.stream("GET", self._path) as stream:
                self.started.set()
                for _ in stream.iter_bytes():
                    pass
        except httpx.HTTPError as error:  # the end was none
            self.fault = error


def site_with_map(running: Running, folder: Path) -> str:
    """A site with a map that no survey made."""
    site_id = new_site(running)
    database = Database(f"sqlite:///{folder / 'scattermark.db'}")
    with database.writing() as session:
        survey_id = SurveyRepository(session).add(site_id, "", None).survey_id
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, publication(site_id, survey_id)))
    database.close()
    return site_id


def test_what_has_begun_is_answered_and_nothing_stays(tmp_path: Path) -> None:
    photo = blank_photo()
    told = threading.Event()

    def body_in_two_parts() -> Iterator[bytes]:
        yield photo[: len(photo) // 2]
        told.wait(WAIT_S)
        yield photo[len(photo) // 2 :]

    with serving(tmp_path, FINISH_S=f"{WAIT_S:.0f}") as running, ThreadPoolExecutor() as crowd:
        client, site_id = running.client, site_with_map(running, tmp_path)
        survey_id = client.post(f"/sites/{site_id}/surveys", json={}).json()["survey_id"]
        trajectory_id = client.post("/trajectories", json={"site_id": site_id}).json()["trajectory_id"]
        watcher = Watcher(client, f"/trajectories/{trajectory_id}/events")
        watcher.start()
        upload = crowd.submit(client.put, f"/surveys/{survey_id}/images/a.png", content=body_in_two_parts())
        snapshot = crowd.submit(client.post, f"/locate?site_id={site_id}", content=body_in_two_parts())
        with connect(running.stream_url(site_id)) as socket:
            # The scrape itself, the watcher, the upload and the snapshot.
            until(lambda: Scrape(client.get("/metrics").text).value("scattermark_http_requests_in_flight") >= 4)
            children = running.children()
            assert children
            running.process.send_signal(signal.SIGTERM)
            until(lambda: any(event["event"] == "Shutting down" for event in running.events()))
            told.set()
            assert snapshot.result(WAIT_S).json()["reason"] == "no-targets"
            assert upload.result(WAIT_S).status_code == 201
            with pytest.raises(ConnectionClosed) as closed:
                socket.recv(WAIT_S)
            assert closed.value.rcvd is not None and closed.value.rcvd.code == SERVICE_RESTART
        watcher.join(WAIT_S)
        assert not watcher.is_alive() and watcher.fault is None
        assert running.process.wait(WAIT_S) == 0
        until(lambda: all(map(is_gone, children)))
        assert running.events()[-1]["event"] in ("stopped", f"Finished server process [{running.process.pid}]")


def test_a_server_that_leaves_says_so_while_it_still_answers_and_told_twice_it_is_gone(tmp_path: Path) -> None:
    with serving(tmp_path, "--no-worker", DRAIN_S=str(WAIT_S)) as running:
        client = running.client
        children = running.children()
        assert client.get("/readyz").json()["status"] == "degraded"  # there is no worker
        running.process.send_signal(signal.SIGTERM)
        until(lambda: client.get("/readyz").status_code == 503)
        leaving = client.get("/readyz").json()
        assert leaving["status"] == "not ready" and "another" in leaving["checks"]["serving"]
        assert client.get("/sites").status_code == 200
        running.process.send_signal(signal.SIGTERM)
        assert running.process.wait(WAIT_S) == SIGTERM_EXIT
        until(lambda: all(map(is_gone, children)))
