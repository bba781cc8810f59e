from __future__ import annotations

from app.services.trajectory_bell import TrajectoryBell


def test_all_who_listen_to_a_trajectory_hear_it_and_nobody_else() -> None:
    bell = TrajectoryBell()
    with bell.heard("a") as first, bell.heard("a") as second, bell.heard("b") as other:
        bell.ring("a")
        assert (first.is_set(), second.is_set(), other.is_set()) == (True, True, False)


def test_who_has_left_is_not_kept() -> None:
    bell = TrajectoryBell()
    with bell.heard("a"):
        pass
    assert bell._heard_by == {}
    bell.ring("a")
