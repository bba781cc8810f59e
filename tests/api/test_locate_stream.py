"""Frames over a WebSocket: each is answered once, the newest first, and whoever breaks off costs nothing."""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from app.api.locate_stream import FRAME_BYTES
from app.settings import Settings
from tests.api.conftest import SurveyedRoom
from tests.api.serving import PROBLEM_TYPE, Served, serve
from tests.api.test_limits import LARGE, site_with_map

ANSWER_S = 60.0
MESSAGE_TOO_BIG, SERVICE_RESTART = 1009, 1012  # RFC 6455, 7.4.1, and its registry


@contextmanager
def stream(served: Served, **query: str) -> Iterator[ClientConnection]:
    address = served.client.base_url.join("/locate/stream").copy_with(scheme="ws", params=query)
    with connect(str(address), compression=None, open_timeout=ANSWER_S) as socket:
        yield socket


def receive(socket: ClientConnection) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(socket.recv(timeout=ANSWER_S))
    return answer


def test_each_frame_gets_its_pose(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    with stream(served, site_id=room.site_id, device_id="streaming") as socket:
        answers = []
        for _ in range(3):
            socket.send(snapshot)
            answers.append(receive(socket))
    assert [answer["frame"] for answer in answers] == [0, 1, 2]
    posted = served.locate(room.site_id, snapshot, device_id="streaming").json()
    for answer in answers:
        assert answer["position_m"] == posted["position_m"]
        assert answer["trajectory_id"] == posted["trajectory_id"]
    assert len({answer["pose_id"] for answer in answers}) == 3
    assert set(answers[0]) == {*posted, "frame"}


def test_words_hold_for_the_next_frame_alone(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    snapshot_id = str(uuid.uuid4())
    with stream(served, site_id=room.site_id) as socket:
        socket.send(json.dumps({"snapshot_id": snapshot_id, "captured_at": 1777627800.25}))
        socket.send(snapshot)
        named = receive(socket)
        socket.send(snapshot)
        plain = receive(socket)
    assert (named["snapshot_id"], named["time_source"]) == (snapshot_id, "client")
    assert named["captured_at"] == "2026-05-01T09:30:00.250000Z"
    assert (plain["snapshot_id"], plain["time_source"]) == (None, "server")


@pytest.mark.parametrize(
    "words", ["no JSON", "[1]", "[" * 5000, '{"site_id": "x"}', '{"captured_at": "noon"}', " " * 20000]
)
def test_words_that_are_wrong_are_the_frames_answer(
    served: Served, room: SurveyedRoom, snapshot: bytes, words: str
) -> None:
    with stream(served, site_id=room.site_id) as socket:
        socket.send(words)
        socket.send(snapshot)
        refused = receive(socket)
        socket.send(snapshot)
        located = receive(socket)
    assert (refused["frame"], refused["status"]) == (0, 422)
    assert refused["type"].endswith("/invalid-input")
    assert located["frame"] == 1
    assert "position_m" in located


def test_a_bad_frame_is_a_problem_and_the_stream_goes_on(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    with stream(served, site_id=room.site_id) as socket:
        socket.send(b"no picture")
        bad = receive(socket)
        socket.send(snapshot)
        good = receive(socket)
    assert (bad["frame"], bad["status"]) == (0, 415)
    assert (good["frame"], "position_m" in good) == (1, True)


def test_the_newest_comes_first_and_each_frame_is_answered_once(served: Served) -> None:
    site_id = site_with_map(served)
    count = 8
    with stream(served, site_id=site_id) as socket:
        for _ in range(count):
            socket.send(LARGE)
        answers = [receive(socket) for _ in range(count)]
    assert sorted(answer["frame"] for answer in answers) == list(range(count))
    kinds = {answer["frame"]: answer["type"].rsplit("/", 1)[-1] for answer in answers}
    assert kinds[count - 1] == "not-located"  # the newest is always looked at
    assert "frame-dropped" in kinds.values()
    looked_at = [answer["frame"] for answer in answers if kinds[answer["frame"]] == "not-located"]
    assert looked_at == sorted(looked_at)  # never back to an older one


@pytest.mark.parametrize(
    ("query", "status", "kind"),
    [
        ({"site_id": "nowhere"}, 404, "not-found"),
        ({}, 422, "invalid-input"),
        ({"site_id": "{room}", "trajectory_id": "nowhere"}, 404, "not-found"),
        ({"site_id": "{room}", "snapshot_id": str(uuid.uuid4())}, 422, "invalid-input"),
        ({"site_id": "{empty}"}, 409, "conflict"),
    ],
)
def test_a_wrong_address_is_refused_before_the_stream_begins(
    served: Served, room: SurveyedRoom, query: dict[str, str], status: int, kind: str
) -> None:
    sites = {"{room}": room.site_id, "{empty}": served.new_site()}
    named = {name: sites.get(value, value) for name, value in query.items()}
    with pytest.raises(InvalidStatus) as refused, stream(served, **named):
        pass
    response = refused.value.response
    assert response.status_code == status
    assert response.headers["content-type"] == PROBLEM_TYPE
    assert json.loads(response.body)["type"].endswith(f"/{kind}")


def test_a_frame_that_is_too_large_ends_the_stream(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    with stream(served, site_id=room.site_id) as socket:
        with suppress(ConnectionClosed):
            socket.send(bytes(FRAME_BYTES + 1))
        with pytest.raises(ConnectionClosed) as closed:
            receive(socket)
    # What the server says last is lost when its end of the line is reset before it is read.
    assert closed.value.rcvd is None or closed.value.rcvd.code == MESSAGE_TOO_BIG
    assert served.locate(room.site_id, snapshot).status_code == 200


def test_who_leaves_takes_no_place_with_him(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    pool = served.services.locator._pool
    for _ in range(4):
        with stream(served, site_id=room.site_id) as socket:
            for _ in range(3):
                socket.send(snapshot)
    assert served.locate(room.site_id, snapshot).status_code == 200
    assert pool.figures.waiting == 0


def test_a_server_that_stops_ends_the_stream(tmp_path_factory: pytest.TempPathFactory) -> None:
    settings = Settings(data_dir=tmp_path_factory.mktemp("stopping"), locate_workers=1, build_workers=1)
    with ExitStack() as outlives:
        with serve(settings, worker=False) as stopping:
            site_id = site_with_map(stopping)
            socket = outlives.enter_context(stream(stopping, site_id=site_id))
            socket.send(LARGE)
            assert receive(socket)["frame"] == 0
        with pytest.raises(ConnectionClosed) as closed:
            receive(socket)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == SERVICE_RESTART
