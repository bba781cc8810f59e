"""Wakes those who watch a trajectory when this process adds to it, so that they need not ask often."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager

WATCH_INTERVAL_S = 0.25  # how late what another process adds may be seen; the bell tells of this one's at once


class TrajectoryBell:
    """One bell per trajectory or live evaluation, heard and rung on one event loop."""

    def __init__(self) -> None:
        self._heard_by: dict[str, set[asyncio.Event]] = {}

    def ring(self, trajectory_id: str) -> None:
        """Say that a trajectory has something new, after it was committed."""
        for rung in self._heard_by.get(trajectory_id, ()):
            rung.set()

    @contextmanager
    def heard(self, *trajectory_ids: str) -> Iterator[asyncio.Event]:
        """An event that is set at each ring for one of these; whoever waits for it clears it before looking."""
        rung = asyncio.Event()
        for trajectory_id in trajectory_ids:
            self._heard_by.setdefault(trajectory_id, set()).add(rung)
        try:
            yield rung
        finally:
            for trajectory_id in trajectory_ids:
                self._forget(trajectory_id, rung)

    def _forget(self, trajectory_id: str, rung: asyncio.Event) -> None:
        listeners = self._heard_by[trajectory_id]
        listeners.discard(rung)
        if not listeners:
            del self._heard_by[trajectory_id]


async def rung_or_late(rung: asyncio.Event) -> None:
    """Wait for the bell, or until it is time to look for what another process added."""
    try:
        async with asyncio.timeout(WATCH_INTERVAL_S):
            await rung.wait()
    except TimeoutError:
        return
