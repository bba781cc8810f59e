"""Headers arrive in reasonable time or the connection closes: the server below would wait for them for ever.

A connection that says nothing costs its sender nothing and the service one of the files that its process may open.
"""

from __future__ import annotations

import asyncio
from typing import ClassVar

from uvicorn.protocols.http.h11_impl import H11Protocol

# How long a connection may rest between two requests. Whoever ends it first must be the client: a request that crosses
# the server's end on its way is lost. Clients of Python let go after 5 s, proxies after 60 s at most.
KEEP_ALIVE_S = 75


class PatientProtocol(H11Protocol):
    """The server's protocol, with an end to its patience between a connection's start and a request's last header.

    Attributes
    ----------
    header_timeout_s : float
        A browser sends its headers at once; connections that it opens in advance it opens again. nginx waits 60 s,
        Apache 20 to 40 s.
    """

    header_timeout_s: ClassVar[float] = 20.0
    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take a connection."""
        super().connection_made(transport)
        self._watch()

    def data_received(self, data: bytes) -> None:
        """Take what came."""
        super().data_received(data)
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        """Let go of a connection."""
        super().connection_lost(exc)
        self._stop_watching()

    def _watch(self) -> None:
        """Await headers from the first byte of a request, or from the connection's start, until they are complete."""
        if not self._awaits_headers():
            self._stop_watching()
        elif self._deadline is None:
            self._deadline = self.loop.call_later(self.header_timeout_s, self._give_up)

    def _awaits_headers(self) -> bool:
        # A connection that became a WebSocket is another protocol's.
        if self.transport.is_closing() or self.transport.get_protocol() is not self:
            return False
        return self.cycle is None or self.cycle.response_complete

    def _stop_watching(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _give_up(self) -> None:
        self._deadline = None
        if self._awaits_headers():
            self.transport.close()
