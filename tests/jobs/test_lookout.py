"""Whoever is silent for eight looks is dead; nobody else is."""

from __future__ import annotations

from app.jobs.lookout import LOOKS_BELIEVED, Lookout
from app.storage.workers import Worker


def worker(beats: int, worker_id: str = "a", *, left: bool = False, age_s: float = 0.0) -> Worker:
    return Worker(worker_id, "host/0", "slot", beats, age_s, left)


def test_silence_is_believed_after_eight_more_looks() -> None:
    lookout = Lookout()
    assert [bool(lookout.look([worker(7)])) for _ in range(LOOKS_BELIEVED + 2)] == [False] * LOOKS_BELIEVED + [True] * 2


def test_a_beat_now_and_then_is_life_however_old_the_row_is() -> None:
    lookout = Lookout()
    for look in range(10 * LOOKS_BELIEVED):
        assert lookout.look([worker(look // LOOKS_BELIEVED, age_s=1e6)]) == ()


def test_a_count_that_falls_is_life_too() -> None:
    lookout = Lookout()
    for look in range(3 * LOOKS_BELIEVED):
        assert lookout.look([worker(look % 2)]) == ()


def test_looks_before_an_outage_count_for_nothing() -> None:
    lookout = Lookout()
    for _ in range(LOOKS_BELIEVED):
        lookout.look([worker(7)])
    lookout.look_failed()
    assert lookout.look([worker(7)]) == ()


def test_who_left_in_order_is_not_waited_for() -> None:
    gone, alive = worker(3, "gone", left=True), worker(3, "alive")
    assert Lookout().look([gone, alive]) == (gone,)


def test_who_was_away_is_not_remembered() -> None:
    lookout = Lookout()
    for _ in range(LOOKS_BELIEVED):
        lookout.look([worker(7)])
    lookout.look([])
    assert lookout.look([worker(7)]) == ()
