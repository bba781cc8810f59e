"""A server on its way out: first it takes itself out of the load balancer, then it ends what would never end."""

from __future__ import annotations

import asyncio


class Draining:
    """Two steps, each taken once and on the event loop.

    Attributes
    ----------
    announced : bool
        The server is not ready for more and still answers all that comes.
    closing : asyncio.Event
        No connection is taken any more; streams without an end of their own end now.
    """

    def __init__(self) -> None:
        self.announced = False
        self.closing = asyncio.Event()

    def announce(self) -> None:
        """Say that the server leaves, so that no more is sent to it."""
        self.announced = True

    def close(self) -> None:
        """End the streams."""
        self.announced = True
        self.closing.set()
