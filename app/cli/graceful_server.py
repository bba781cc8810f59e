"""A server that stops in order: out of the load balancer, streams ended, requests finished; told twice, at once."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
from collections.abc import Callable
from types import FrameType

import uvicorn

from app.services.draining import Draining

log = logging.getLogger(__name__)

SIGNALLED = 128  # the shell's convention: a process that a signal ended


class GracefulServer(uvicorn.Server):
    """uvicorn's server with this service's way of stopping. It ends by returning, not by the signal.

    Parameters
    ----------
    config : uvicorn.Config
    draining : Draining
        Of the application: what readiness and streams watch.
    drain_s : float
        How long it says that it leaves and still takes requests. Requests in flight are then waited for as long as
        ``config`` says.

    Attributes
    ----------
    beside : list of callable
        Stops of what runs beside the server: begun with its own, so that all together keep within the time.
    """

    def __init__(self, config: uvicorn.Config, draining: Draining, drain_s: float) -> None:
        super().__init__(config)
        self._draining = draining
        self._drain_s = drain_s
        self.beside: list[Callable[[], None]] = []

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:  # noqa: ARG002 - uvicorn's signature
        """The first signal asks for a stop, the second does not wait for it."""
        if self.should_exit:
            # As safe as a kill -9: every child process watches for the end of this one.
            os._exit(SIGNALLED + sig)
        self.should_exit = True

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Stop, in the order that loses nothing."""
        log.info("stopping")
        self._draining.announce()
        await asyncio.sleep(self._drain_s)
        self._draining.close()
        stops = [asyncio.to_thread(stop) for stop in self.beside]
        await asyncio.gather(super().shutdown(sockets), *stops)
        log.info("stopped")
