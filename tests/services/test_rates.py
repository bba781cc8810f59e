from __future__ import annotations

import pytest

from app.errors import InvalidInput, TooManyRequests
from app.services import rates
from app.services.rates import Rate, RateLimiter


class Clock:
    """A clock that is set."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


def admitted(limiter: RateLimiter, rate: Rate, asker: str = "a") -> bool:
    try:
        limiter.spend(asker, rate)
    except TooManyRequests:
        return False
    return True


def test_a_burst_comes_at_once_and_the_rest_in_time() -> None:
    clock = Clock()
    limiter, rate = RateLimiter(clock), Rate(per_s=2.0, burst=3)
    assert [admitted(limiter, rate) for _ in range(4)] == [True, True, True, False]
    clock.now_s += 0.5
    assert [admitted(limiter, rate) for _ in range(2)] == [True, False]
    clock.now_s += 100.0
    assert [admitted(limiter, rate) for _ in range(4)] == [True, True, True, False]


def test_in_the_long_run_it_is_the_rate() -> None:
    clock = Clock()
    limiter, rate = RateLimiter(clock), Rate(per_s=5.0, burst=10)
    count = 0
    for _ in range(10_000):  # a hundred times a second for a hundred seconds
        count += admitted(limiter, rate)
        clock.now_s += 0.01
    assert count == pytest.approx(5.0 * 100.0 + 10, abs=1)


def test_askers_do_not_share() -> None:
    limiter, rate = RateLimiter(Clock()), Rate(1.0, 1)
    assert [admitted(limiter, rate, asker) for asker in "abab"] == [True, True, False, False]


def test_whoever_comes_when_told_is_let_in() -> None:
    clock = Clock()
    limiter, rate = RateLimiter(clock), Rate(0.3, 2)
    while admitted(limiter, rate):
        pass
    with pytest.raises(TooManyRequests) as refused:
        limiter.spend("a", rate)
    wait_s = refused.value.fields["retry_after_s"]
    assert wait_s == 4  # 1 / 0.3, in whole seconds
    clock.now_s += wait_s
    assert admitted(limiter, rate)


def test_a_refusal_costs_nothing() -> None:
    clock = Clock()
    limiter, rate = RateLimiter(clock), Rate(1.0, 1)
    assert [admitted(limiter, rate) for _ in range(50)] == [True] + [False] * 49
    clock.now_s += 1.0
    assert admitted(limiter, rate)


def test_idle_askers_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rates, "REMEMBERED", 3)
    clock = Clock()
    limiter, slow = RateLimiter(clock), Rate(0.001, 1)
    assert admitted(limiter, slow, "busy")
    for asker in "abcdef":
        assert admitted(limiter, Rate(10.0, 1), asker)
        clock.now_s += 1.0
    assert len(limiter._due_s) <= 4
    assert not admitted(limiter, slow, "busy")


@pytest.mark.parametrize(("per_s", "burst"), [(0.0, 1), (-1.0, 1), (float("inf"), 1), (float("nan"), 1), (1.0, 0)])
def test_rates_that_let_nobody_or_everybody_in_are_none(per_s: float, burst: int) -> None:
    with pytest.raises(InvalidInput):
        Rate(per_s, burst)
