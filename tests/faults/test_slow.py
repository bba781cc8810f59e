"""Clients that say little and stay long: they are sent away, and whoever comes in earnest is answered meanwhile."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import replace

import pytest

from app.api.slow_headers import PatientProtocol
from app.settings import Settings
from tests.api.serving import Served, room_photos, serve
from tests.faults.ledger import SNAPSHOT_BYTES, Ledger
from tests.faults.wire import answer_of, connected, head

GRACE_S = 1.0
HEADERS_S = 0.5
MOST_SLOW = 4
CROWD = 60
PHOTO = room_photos("survey")["IMG_0001.jpg"]


@pytest.fixture(scope="module")
def impatient(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ledger]:
    """A service that waits for seconds where others wait for half a minute."""
    folder = tmp_path_factory.mktemp("impatient")
    settings = Settings(data_dir=folder, locate_workers=1, build_workers=1)
    limits = replace(settings, upload_grace_s=GRACE_S, max_slow_uploads=MOST_SLOW)
    with pytest.MonkeyPatch.context() as patience:
        patience.setattr(PatientProtocol, "header_timeout_s", HEADERS_S)
        with serve(limits, worker=False) as running, closing(Ledger(running)) as kept:
            yield kept
            kept.check()


def upload_head(ledger: Ledger, name: str, length: int = len(PHOTO)) -> bytes:
    return head("PUT", f"/surveys/{ledger.survey_id}/images/{name}", Content_Length=length)


def crowd(served: Served, size: int, opened: ExitStack) -> list[socket.socket]:
    return [opened.enter_context(connected(served)) for _ in range(size)]


def test_a_connection_that_says_nothing_is_closed(impatient: Ledger) -> None:
    with connected(impatient.served) as connection:
        assert answer_of(connection) == (0, b"")


def test_headers_without_an_end_are_waited_for_no_longer(impatient: Ledger) -> None:
    said = (b"G", b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n", b"GET /healthz HTTP/1.1\r\nX: ")
    with ExitStack() as opened:
        connections = crowd(impatient.served, len(said), opened)
        for connection, part in zip(connections, said, strict=True):
            connection.sendall(part)
        assert [answer_of(connection) for connection in connections] == [(0, b"")] * len(said)


def test_headers_that_trickle_gain_no_time_by_it(impatient: Ledger) -> None:
    with connected(impatient.served) as connection:
        closed = threading.Event()
        trickle = threading.Thread(target=_trickle, args=(connection, closed))
        trickle.start()
        assert answer_of(connection) == (0, b"")
        closed.set()
        trickle.join()


def _trickle(connection: socket.socket, closed: threading.Event) -> None:
    """A header a tenth of a second, until the server has closed."""
    connection.sendall(b"GET /healthz HTTP/1.1\r\n")
    while not closed.wait(0.1):
        try:
            connection.sendall(b"X: y\r\n")
        except OSError:
            return


def test_a_second_request_on_a_connection_has_no_more_time_than_the_first(impatient: Ledger) -> None:
    with connected(impatient.served) as connection:
        connection.sendall(head("GET", "/healthz"))
        answer = b""
        while not answer.endswith(b"}"):
            answer += connection.recv(65536)
        connection.sendall(b"GET /healthz HTTP/1.1\r\n")
        assert answer_of(connection) == (0, b"")


def test_a_body_that_does_not_come_is_told_so(impatient: Ledger) -> None:
    with connected(impatient.served) as connection:
        connection.sendall(upload_head(impatient, "stalled.jpg") + PHOTO[:2000])
        status, answer = answer_of(connection)
    assert status == 408
    assert b"application/problem+json" in answer
    assert b"/too-slow" in answer
    assert b"2000 bytes of the body came" in answer


def test_every_kind_of_body_has_an_end(impatient: Ledger) -> None:
    kinds = {"application/json": b"{", "multipart/form-data; boundary=x": b"--x\r\n", "image/jpeg": PHOTO[:100]}
    requests = [
        head("POST", target, Content_Type=kind, Content_Length=1000) + body
        for kind, body in kinds.items()
        for target in ("/sites", "/locate", "/locate?site_id=x")
    ]
    with ExitStack() as opened:
        connections = crowd(impatient.served, len(requests), opened)
        for connection, request in zip(connections, requests, strict=True):
            connection.sendall(request)
        # What is found wrong before need not wait for the body; nobody waits for ever.
        assert {answer_of(connection)[0] for connection in connections} <= {408, 422, 503}


def test_a_slow_body_above_the_least_pace_arrives(impatient: Ledger) -> None:
    data = PHOTO[:-1]  # of so many bytes that it may take seconds more
    with connected(impatient.served) as connection:
        connection.sendall(upload_head(impatient, "patient.jpg", len(PHOTO)) + data)
        threading.Event().wait(1.5 * GRACE_S)
        connection.sendall(PHOTO[-1:])
        assert connection.recv(65536).startswith(b"HTTP/1.1 201")


def test_whoever_comes_in_earnest_is_answered_while_a_crowd_trickles(impatient: Ledger) -> None:
    with ExitStack() as opened:
        silent = crowd(impatient.served, CROWD, opened)
        uploading = crowd(impatient.served, MOST_SLOW, opened)
        for number, connection in enumerate(uploading):
            connection.sendall(upload_head(impatient, f"slow-{number}.jpg") + PHOTO[:100])
        located = impatient.locate(SNAPSHOT_BYTES)
        assert located.status_code == 200
        assert impatient.served.client.get("/healthz").status_code == 200
        assert [answer_of(connection)[0] for connection in silent] == [0] * CROWD
        assert {answer_of(connection)[0] for connection in uploading} == {408}


def test_only_so_many_bodies_may_be_slow_at_a_time(impatient: Ledger) -> None:
    with ExitStack() as opened:
        uploading = crowd(impatient.served, 4 * MOST_SLOW, opened)
        for number, connection in enumerate(uploading):
            connection.sendall(upload_head(impatient, f"many-{number}.jpg") + PHOTO[:100])
        answers = [answer_of(connection) for connection in uploading]
    assert {status for status, _ in answers} == {408, 503}
    refused = next(answer for status, answer in answers if status == 503)
    assert b"retry-after: 10" in refused.lower()
    assert impatient.upload("afterwards.jpg", PHOTO).status_code == 201
