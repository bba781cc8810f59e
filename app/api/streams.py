"""Streams end with the server: a watcher would otherwise hold it until its time limit.

Done here once for all streams of events, so that none can forget it: on closing, whoever produces the stream learns
that its reader has left, and the reader gets a proper end, after which it connects again, to another server or to the
next one. Sockets need none of this: uvicorn closes them with 1012, service restart.
"""

from __future__ import annotations

import asyncio

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.services.draining import Draining

EVENT_STREAM = b"text/event-stream"


class StreamsEndWithServer:
    """Ends the answers that are streams of events when the server closes."""

    def __init__(self, app: ASGIApp, draining: Draining) -> None:
        self._app = app
        self._draining = draining

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        exchange = _Exchange(receive, send, self._draining.closing)
        await self._app(scope, exchange.receive, exchange.send)
        await exchange.finish()


class _Exchange:
    """One request and its answer, as the application sees them."""

    def __init__(self, receive: Receive, send: Send, closing: asyncio.Event) -> None:
        self._receive = receive
        self._send = send
        self._closing = closing
        self._all_received = False
        self._streams = asyncio.Event()
        self._cut = False

    async def send(self, message: Message) -> None:
        """Pass a part of the answer on."""
        if message["type"] == "http.response.start" and is_event_stream(message):
            self._streams.set()
        if not self._cut:
            await self._send(message)

    async def receive(self) -> Message:
        """The next part of the request; after the last, the news that its reader left or that the server closes."""
        if self._all_received:
            return await self._wait_for_end()
        message = await self._receive()
        self._all_received = message["type"] == "http.disconnect" or not message.get("more_body", False)
        return message

    async def finish(self) -> None:
        """Give a stream that was cut its proper end."""
        if self._cut:
            await self._send({"type": "http.response.body", "body": b"", "more_body": False})

    async def _wait_for_end(self) -> Message:
        reader_left = asyncio.ensure_future(self._receive())
        cut = asyncio.ensure_future(self._wait_for_cut())
        try:
            await asyncio.wait({reader_left, cut}, return_when=asyncio.FIRST_COMPLETED)
            if reader_left.done():
                return reader_left.result()
            self._cut = True
            return {"type": "http.disconnect"}
        finally:
            reader_left.cancel()
            cut.cancel()

    async def _wait_for_cut(self) -> None:
        await self._streams.wait()
        await self._closing.wait()


def is_event_stream(start: Message) -> bool:
    """Whether an answer is a stream of server-sent events."""
    kinds = (value for name, value in start["headers"] if name.lower() == b"content-type")
    return any(kind.startswith(EVENT_STREAM) for kind in kinds)
