"""A call that hangs is waited for no longer than wished, and holds one thread however often it is asked for."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator

import pytest

from app.services.bounded import Bounded

LONG_S = 60.0
SHORT_S = 0.05


class Hanging:
    """A call that waits to be released."""

    def __init__(self) -> None:
        self.released = threading.Event()
        self.calls = 0

    def __call__(self) -> int:
        self.calls += 1
        self.released.wait(LONG_S)
        return self.calls


@pytest.fixture
def hanging() -> Iterator[Hanging]:
    hanging = Hanging()
    yield hanging
    hanging.released.set()


def test_the_outcome_or_the_error_comes_back() -> None:
    assert Bounded(lambda: 42, LONG_S).ask() == 42
    with pytest.raises(ZeroDivisionError):
        Bounded(lambda: 1 // 0, LONG_S).ask()


def test_a_hanging_call_is_begun_once(hanging: Hanging) -> None:
    bounded = Bounded(hanging, SHORT_S)
    for _ in range(3):
        with pytest.raises(TimeoutError):
            bounded.ask()
    assert hanging.calls == 1


def test_an_event_loop_waits_no_longer_either(hanging: Hanging) -> None:
    bounded = Bounded(hanging, SHORT_S)

    async def ask_thrice() -> list[int | BaseException]:
        return await asyncio.gather(*(bounded.outcome() for _ in range(3)), return_exceptions=True)

    assert [type(outcome) for outcome in asyncio.run(ask_thrice())] == [TimeoutError] * 3
    assert hanging.calls == 1


def test_whoever_asks_meanwhile_shares_the_call_and_the_next_begins_another(hanging: Hanging) -> None:
    bounded = Bounded(hanging, LONG_S)

    async def ask_both() -> list[int]:
        asking = [asyncio.ensure_future(bounded.outcome()) for _ in range(2)]
        await asyncio.sleep(0)
        hanging.released.set()
        return await asyncio.gather(*asking)

    assert asyncio.run(ask_both()) == [1, 1]
    assert bounded.ask() == 2
