"""Bodies arrive in reasonable time or not at all: one that trickles would hold memory, a file and a connection.

The server below waits for a body without limit. Here a body has a grace and then a least pace; and only so many at a
time may be slow, so that a crowd of them cannot hold all that there is to hold.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass

from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

TOO_SLOW = 408
TOO_MANY = 503
# The answer leaves before the body is there: nothing else can follow on this connection.
CLOSE = {"Connection": "close"}


@dataclass(frozen=True)
class Patience:
    """How slowly a body may come.

    Attributes
    ----------
    grace_s : float
        Time for any body; from half of it on a body counts as slow.
    least_bytes_per_s : float
        Each byte that has come extends the grace by as much: half of what a phone sends where it has EDGE only.
        Apache's mod_reqtimeout works the same way, with 20 s and 500 bytes/s.
    most_slow : int
        Slow bodies at a time.
    retry_after_s : int
        When to come back after there were too many.
    """

    grace_s: float = 20.0
    least_bytes_per_s: float = 4096.0
    most_slow: int = 128
    retry_after_s: int = 10


class SlowBodies:
    """Ends the wait for a body that comes too slowly: 408, or 503 when too many are slow already."""

    def __init__(self, app: ASGIApp, patience: Patience) -> None:
        self._app = app
        self._patience = patience
        self._slow: set[_Body] = set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        body = _Body(receive, self._patience, self._slow)
        try:
            await self._app(scope, body.receive, send)
        finally:
            self._slow.discard(body)


class _Body:
    """One body on its way in."""

    def __init__(self, receive: Receive, patience: Patience, slow: set[_Body]) -> None:
        self._receive = receive
        self._patience = patience
        self._slow = slow
        self._began_s = asyncio.get_running_loop().time()
        self._received_bytes = 0
        self._complete = False

    async def receive(self) -> Message:
        """The next part of the request."""
        if self._complete:
            return await self._receive()
        message = await self._wait_for_part()
        self._received_bytes += len(message.get("body", b""))
        self._complete = message["type"] == "http.disconnect" or not message.get("more_body", False)
        if self._complete:
            self._slow.discard(self)
        return message

    async def _wait_for_part(self) -> Message:
        if self not in self._slow:
            try:
                async with asyncio.timeout_at(self._began_s + self._patience.grace_s / 2):
                    return await self._receive()
            except TimeoutError:
                self._count_as_slow()
        extension_s = self._received_bytes / self._patience.least_bytes_per_s
        try:
            async with asyncio.timeout_at(self._began_s + self._patience.grace_s + extension_s):
                return await self._receive()
        except TimeoutError as error:
            detail = f"{self._received_bytes} bytes of the body came, and no more in time"
            raise HTTPException(TOO_SLOW, detail, headers=CLOSE) from error

    def _count_as_slow(self) -> None:
        if len(self._slow) >= self._patience.most_slow:
            raise HTTPException(
                TOO_MANY,
                f"{len(self._slow)} bodies come slowly already; send the request again in "
                f"{self._patience.retry_after_s} s, over a faster connection if there is one",
                headers={**CLOSE, "Retry-After": str(self._patience.retry_after_s)},
            )
        self._slow.add(self)
