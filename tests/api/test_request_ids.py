"""One id per request: the client's or ours, in the answer's header, in the problem and in the log."""

from __future__ import annotations

import asyncio
import logging

import httpx
import pytest
from fastapi import WebSocket
from starlette.types import Message, Receive, Scope, Send

from app.api.faults import INTERNAL_ERROR, FaultsAsProblems
from app.api.request_id import RequestIds
from app.logs import log_context
from tests.api.serving import Served, assert_problem


def test_a_clients_id_comes_back_and_is_in_the_problem(served: Served) -> None:
    answer = served.client.get("/sites/nothing", headers={"X-Request-ID": "phone-7.1234"})
    assert answer.headers["X-Request-ID"] == "phone-7.1234"
    assert assert_problem(answer, 404, "not-found")["request_id"] == "phone-7.1234"


def test_every_answer_has_an_id_of_its_own(served: Served) -> None:
    answers = [served.client.get(path) for path in ("/healthz", "/healthz", "/nowhere")]
    answers.append(served.client.post("/sites", content=b"{" * 9_000_000))  # refused before any route
    ids = [answer.headers["X-Request-ID"] for answer in answers]
    assert len(set(ids)) == len(ids)
    assert [answer.json()["request_id"] for answer in answers[2:]] == ids[2:]


@pytest.mark.parametrize("given", ["", "two words", "a" * 65, "<script>", '{"level":"error"}'])
def test_what_is_no_plain_word_is_replaced(served: Served, given: str) -> None:
    answer = served.client.get("/nowhere", headers={"X-Request-ID": given})
    assert answer.headers["X-Request-ID"] == answer.json()["request_id"] != given


async def broken(scope: Scope, receive: Receive, send: Send) -> None:
    """An application with a fault that it meets before, or in the middle of, its answer."""
    if scope["type"] == "websocket":
        socket = WebSocket(scope, receive, send)
        await socket.accept()
    elif scope["path"] == "/half":
        await send({"type": "http.response.start", "status": 200, "headers": []})
    raise ZeroDivisionError("the secret of the fault")


def test_a_fault_is_a_problem_that_leads_to_the_log(caplog: pytest.LogCaptureFixture) -> None:
    seen: list[object] = []

    class Watching(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            seen.append((record.levelname, log_context()["request_id"], record.exc_info is not None))

    watching = Watching()
    logging.getLogger("app.api.faults").addHandler(watching)
    try:
        answer = asyncio.run(ask("/whole"))
    finally:
        logging.getLogger("app.api.faults").removeHandler(watching)
    problem = assert_problem(answer, 500, "fault")
    assert problem["request_id"] == answer.headers["X-Request-ID"]
    assert "secret" not in answer.text
    assert seen == [("ERROR", problem["request_id"], True)]
    assert "the secret of the fault" in caplog.text


def test_who_is_cut_off_by_the_servers_end_is_told_to_come_again() -> None:
    async def cut_off() -> list[Message]:
        sent: list[Message] = []
        waiting = asyncio.Event()

        async def endless(_scope: Scope, _receive: Receive, _send: Send) -> None:
            waiting.set()
            await asyncio.Event().wait()

        async def send(message: Message) -> None:
            sent.append(message)

        scope = {"type": "http", "path": "/", "method": "GET", "headers": []}
        task = asyncio.ensure_future(FaultsAsProblems(endless)(scope, None, send))  # type: ignore[arg-type]
        await waiting.wait()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        return sent

    start, body = asyncio.run(cut_off())
    assert start["status"] == 503
    assert (b"retry-after", b"5") in start["headers"]
    assert b"send the request again" in body["body"]


def test_half_an_answer_never_looks_like_a_whole_one() -> None:
    with pytest.raises(ZeroDivisionError):  # the server breaks the connection
        asyncio.run(ask("/half"))


async def ask(path: str) -> httpx.Response:
    transport = httpx.ASGITransport(RequestIds(FaultsAsProblems(broken)))
    async with httpx.AsyncClient(transport=transport, base_url="http://test") as client:
        return await client.get(path)


def test_a_fault_closes_a_socket_with_its_code() -> None:
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def send(message: Message) -> None:
        sent.append(message)

    scope = {"type": "websocket", "path": "/", "headers": [], "query_string": b""}
    asyncio.run(FaultsAsProblems(broken)(scope, receive, send))
    assert [message["type"] for message in sent] == ["websocket.accept", "websocket.close"]
    assert sent[-1]["code"] == INTERNAL_ERROR
