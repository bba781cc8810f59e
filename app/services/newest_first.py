"""A queue for one who cannot keep up: only the newest waits."""

from __future__ import annotations

import asyncio
from typing import Generic, TypeVar

Item = TypeVar("Item")


class NewestFirst(Generic[Item]):
    """Holds one item at most; a newer one takes its place. Used on one event loop."""

    def __init__(self) -> None:
        self._item: Item | None = None
        self._ended = False
        self._changed = asyncio.Event()

    def put(self, item: Item) -> Item | None:
        """Let an item wait; the one that waited in its place, if there was one."""
        displaced, self._item = self._item, item
        self._changed.set()
        return displaced

    def end(self) -> None:
        """Nothing more comes, and what waits is not wanted any more."""
        self._item, self._ended = None, True
        self._changed.set()

    async def get(self) -> Item | None:
        """The newest item once there is one; None at the end."""
        while self._item is None and not self._ended:
            self._changed.clear()
            await self._changed.wait()
        item, self._item = self._item, None
        return item
