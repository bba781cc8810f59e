"""Only the newest waits; who was displaced is told, the end is heard."""

from __future__ import annotations

import asyncio

from app.services.newest_first import NewestFirst


def test_a_newer_item_takes_the_place_of_one_that_waits() -> None:
    async def story() -> None:
        waiting: NewestFirst[int] = NewestFirst()
        assert waiting.put(1) is None
        assert waiting.put(2) == 1
        assert await waiting.get() == 2
        reader = asyncio.create_task(waiting.get())
        await asyncio.sleep(0)
        assert not reader.done()
        assert waiting.put(3) is None
        assert await reader == 3

    asyncio.run(story())


def test_the_end_is_heard_and_leaves_nothing() -> None:
    async def story() -> None:
        waiting: NewestFirst[int] = NewestFirst()
        reader = asyncio.create_task(waiting.get())
        await asyncio.sleep(0)
        waiting.end()
        assert await reader is None
        waiting = NewestFirst()
        waiting.put(1)
        waiting.end()
        assert await waiting.get() is None

    asyncio.run(story())
