"""The gate counts, refuses and says when to come back."""

from __future__ import annotations

import pytest

from app.errors import ServerFull
from app.jobs.gate import Gate


def test_lets_in_workers_and_queue_and_no_more() -> None:
    gate = Gate(workers=2, queue_depth=3)
    for _ in range(5):
        gate.enter()
    with pytest.raises(ServerFull):
        gate.enter()
    assert gate.in_flight == 5
    gate.leave(0.1)
    gate.enter()


def test_retry_after_follows_the_pace() -> None:
    gate = Gate(workers=2, queue_depth=8)
    assert gate.retry_after_s == 1
    for _ in range(100):
        gate.enter()
        gate.leave(3.0)
    assert gate.retry_after_s == 15  # ten places over two workers at three seconds each


def test_work_that_never_began_says_nothing_about_the_pace() -> None:
    gate = Gate(workers=1, queue_depth=0)
    gate.enter()
    gate.leave(None)
    assert gate.retry_after_s == 1
    assert gate.in_flight == 0


@pytest.mark.parametrize(("workers", "queue_depth"), [(0, 1), (1, -1)])
def test_refuses_impossible_sizes(workers: int, queue_depth: int) -> None:
    with pytest.raises(ValueError, match="at least one worker"):
        Gate(workers, queue_depth)
