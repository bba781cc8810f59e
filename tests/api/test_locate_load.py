"""Thirty-two clients at once: every answer is committed, refusals say when to come back, nothing is lost or doubled."""

from __future__ import annotations

import json
import socket
import time
import uuid
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection
from typing import Any

import pytest
from sqlalchemy import select

from app.settings import Settings
from app.storage.models import SnapshotRow, TrajectoryRow
from tests.api.serving import Served, room_photos, serve
from tests.api.test_limits import site_with_map
from tests.databases import Databases

CLIENTS = 32
EACH = 4
DEVICES = 5
DEADLINE_S = 240.0  # of a loaded machine
SNAPSHOT = room_photos("locate")["IMG_0000.jpg"]


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def loaded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    databases: Databases = request.getfixturevalue(request.param)
    url = databases.migrated()
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("loaded"), database_url=url, locate_workers=2, build_workers=1, queue_depth=4
    )
    with serve(settings, worker=False) as running:
        yield running
    databases.take_back(url)


def post(served: Served, body: bytes, **query: str) -> tuple[int, dict[str, Any], dict[str, str]]:
    """One request on a connection of its own."""
    base = served.client.base_url
    connection = HTTPConnection(base.host, base.port, timeout=DEADLINE_S)
    address = served.client.build_request("POST", "/locate", params=query).url
    connection.request("POST", address.raw_path.decode(), body, {"Content-Type": "image/jpeg"})
    response = connection.getresponse()
    answer = json.loads(response.read())
    connection.close()
    return response.status, answer, {name.lower(): value for name, value in response.getheaders()}


def until(condition: Any) -> None:
    deadline_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline_s
        time.sleep(0.005)


def test_every_answer_is_committed_and_every_refusal_says_when(loaded: Served) -> None:
    site_id = site_with_map(loaded)

    def client(number: int) -> list[dict[str, Any]]:
        answered = []
        while len(answered) < EACH:
            status, answer, headers = post(loaded, SNAPSHOT, site_id=site_id, device_id=f"phone-{number % DEVICES}")
            if status == 503:
                assert answer["type"].endswith("/server-full")
                assert int(headers["retry-after"]) == answer["retry_after_s"] >= 1
                refusals[number] += 1
                time.sleep(0.01)  # not the second it was told: the load shall stay
                continue
            assert status in (200, 422), answer
            answered.append(answer)
        return answered

    refusals: Counter[int] = Counter()
    with ThreadPoolExecutor(CLIENTS) as crowd:
        answers = [answer for found in crowd.map(client, range(CLIENTS)) for answer in found]
    assert refusals.total() > 0
    with loaded.services.database.reading() as session:
        rows = session.scalars(select(SnapshotRow).where(SnapshotRow.site_id == site_id)).all()
        trajectories = session.scalars(select(TrajectoryRow).where(TrajectoryRow.site_id == site_id)).all()
    assert {row.id for row in rows} == {answer["pose_id"] for answer in answers}
    assert len(rows) == CLIENTS * EACH
    assert len(trajectories) == DEVICES
    for trajectory in trajectories:
        ordinals = sorted(row.ordinal for row in rows if row.trajectory_id == trajectory.id)
        assert ordinals == list(range(1, trajectory.snapshot_count + 1))
    assert loaded.services.locator._pool.in_flight == 0  # type: ignore[attr-defined]


def test_one_id_from_many_at_once_is_one_snapshot(loaded: Served) -> None:
    site_id = site_with_map(loaded)
    name = str(uuid.uuid4())

    def client(_number: int) -> str:
        while True:
            status, answer, _ = post(loaded, SNAPSHOT, site_id=site_id, snapshot_id=name)
            if status != 503:
                return str(answer["pose_id"])
            time.sleep(0.01)

    with ThreadPoolExecutor(CLIENTS) as crowd:
        poses = set(crowd.map(client, range(8)))
    assert len(poses) == 1
    with loaded.services.database.reading() as session:
        assert session.query(SnapshotRow).filter_by(site_id=site_id).count() == 1


def test_clients_that_leave_take_no_place_with_them(loaded: Served) -> None:
    site_id = site_with_map(loaded)
    base = loaded.client.base_url
    head = f"POST /locate?site_id={site_id} HTTP/1.1\r\nHost: {base.host}\r\nContent-Length: {len(SNAPSHOT)}\r\n\r\n"
    for sent in (SNAPSHOT, SNAPSHOT[:1000]):  # after the whole request, and in the middle of it
        for _ in range(10):
            with socket.create_connection((base.host, base.port)) as connection:
                connection.sendall(head.encode() + sent)
    until(lambda: post(loaded, SNAPSHOT, site_id=site_id)[0] in (200, 422))
    until(lambda: loaded.services.locator._pool.figures.waiting == 0)
    until(lambda: loaded.services.locator._pool.in_flight == 0)  # type: ignore[attr-defined]
