"""A stream of events ends with the server, properly; no other answer is touched."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

import pytest
from starlette.responses import PlainTextResponse, StreamingResponse
from starlette.types import Message, Receive, Scope, Send

from app.api.streams import EVENT_STREAM, StreamsEndWithServer
from app.services.draining import Draining

SCOPE = {"type": "http", "method": "GET", "path": "/", "headers": [], "asgi": {"version": "3.0", "spec_version": "2.3"}}


class Client:
    """Sends one request and stays until the answer ends or it is told to leave."""

    def __init__(self) -> None:
        self.got: list[Message] = []
        self.first_part = asyncio.Event()
        self.leaves = asyncio.Event()
        self._asked = False

    async def receive(self) -> Message:
        if not self._asked:
            self._asked = True
            return {"type": "http.request", "body": b"", "more_body": False}
        await self.leaves.wait()
        return {"type": "http.disconnect"}

    async def send(self, message: Message) -> None:
        self.got.append(message)
        if message.get("body"):
            self.first_part.set()

    @property
    def ended(self) -> bool:
        return not self.got[-1].get("more_body", False)


async def endless(scope: Scope, receive: Receive, send: Send) -> None:
    """A stream of one event, and then silence."""

    async def events() -> AsyncIterator[bytes]:
        yield b"data: 1\n\n"
        await asyncio.Event().wait()

    await receive()
    await StreamingResponse(events(), media_type=scope["path"][1:])(scope, receive, send)


async def watch(media_type: str, draining: Draining) -> tuple[Client, asyncio.Task[None]]:
    client = Client()
    app = StreamsEndWithServer(endless, draining)
    task = asyncio.ensure_future(app({**SCOPE, "path": f"/{media_type}"}, client.receive, client.send))
    await client.first_part.wait()
    return client, task


def test_a_watcher_gets_a_proper_end_when_the_server_closes() -> None:
    async def story() -> Client:
        draining = Draining()
        client, task = await watch("text/event-stream", draining)
        draining.announce()
        assert not draining.closing.is_set()  # only told to leave: the watcher stays
        draining.close()
        await task
        return client

    client = asyncio.run(story())
    assert [message.get("body") for message in client.got] == [None, b"data: 1\n\n", b""]
    assert client.ended


def test_a_stream_that_begins_while_the_server_closes_ends_too() -> None:
    async def story() -> Client:
        draining = Draining()
        draining.close()
        client, task = await watch("text/event-stream", draining)
        await task
        return client

    assert asyncio.run(story()).ended


def test_a_watcher_that_leaves_ends_its_stream() -> None:
    async def story() -> Client:
        client, task = await watch("text/event-stream", Draining())
        client.leaves.set()
        await task
        return client

    assert not asyncio.run(story()).ended  # nobody is there to be told


def test_what_is_no_stream_of_events_goes_on() -> None:
    async def story() -> bool:
        draining = Draining()
        client, task = await watch("text/csv", draining)
        draining.close()
        await asyncio.sleep(0)
        went_on = not task.done()
        client.leaves.set()
        await task
        return went_on

    assert asyncio.run(story())


@pytest.mark.parametrize("closing", [False, True])
def test_a_plain_answer_is_as_it_was(closing: bool) -> None:
    async def story() -> Client:
        draining, client = Draining(), Client()
        if closing:
            draining.close()
        await StreamsEndWithServer(PlainTextResponse("hello"), draining)(SCOPE, client.receive, client.send)
        return client

    client = asyncio.run(story())
    assert client.got[1]["body"] == b"hello"
    assert EVENT_STREAM not in dict(client.got[0]["headers"])[b"content-type"]
