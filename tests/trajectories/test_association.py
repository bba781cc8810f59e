from __future__ import annotations

import numpy as np
import pytest

from app.trajectories.association import AssociationOptions, associate, nearest_rows
from app.trajectories.no_match import NothingMatched
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import START_S, walk, walk_at


def at(*times_s: float) -> Trajectory:
    return Trajectory(np.array(times_s), np.column_stack([times_s, np.zeros((len(times_s), 2))]))


def test_interpolation_gives_the_reference_at_the_estimates_stamps() -> None:
    pairs = associate(walk(20.0), walk_at(START_S + np.arange(-1.0, 25.0, 0.33)), AssociationOptions(course="spline"))
    np.testing.assert_array_equal(pairs.reference.times_s, pairs.estimate.times_s)
    np.testing.assert_allclose(pairs.reference.positions_m, pairs.estimate.positions_m, atol=1e-3)
    assert pairs.estimate_rows[0] == 4 and pairs.estimate_count == 79


def test_the_nearest_of_the_longer_belongs_to_each_of_the_shorter() -> None:
    nearest = AssociationOptions("nearest", max_gap_s=0.2)
    pairs = associate(at(0.0, 1.0, 2.0, 3.0), at(0.9, 2.15, 2.5), nearest)
    assert pairs.reference.times_s.tolist() == [1.0, 2.0]
    assert pairs.estimate_rows.tolist() == [0, 1]
    turned = associate(at(0.9, 2.15, 2.5), at(0.0, 1.0, 2.0, 3.0), nearest)
    assert turned.reference.times_s.tolist() == [0.9, 2.15]
    assert turned.estimate_rows.tolist() == [1, 2]


def test_the_last_word_of_the_system_counts_and_no_later_one() -> None:
    pairs = associate(at(1.0, 2.0, 3.0), at(0.5, 2.0, 2.9, 3.1), AssociationOptions("last", max_gap_s=0.6))
    assert pairs.reference.times_s.tolist() == [1.0, 2.0, 3.0]
    assert pairs.estimate_rows.tolist() == [0, 1, 2]
    stale = associate(at(1.0, 2.0), at(0.5, 2.0), AssociationOptions("last", max_gap_s=0.1))
    assert stale.reference.times_s.tolist() == [2.0]


def test_an_offset_is_added_to_the_estimates_clock() -> None:
    pairs = associate(at(10.0, 11.0), at(0.0, 1.0), AssociationOptions("nearest", max_gap_s=0.01), time_offset_s=10.0)
    assert pairs.estimate.times_s.tolist() == [10.0, 11.0]


def test_of_two_equally_near_stamps_the_earlier_is_taken() -> None:
    assert nearest_rows(np.array([0.0, 1.0]), np.array([0.5, -3.0, 7.0])).tolist() == [0, 0, 1]
    assert nearest_rows(np.array([4.0]), np.array([0.0, 9.0])).tolist() == [0, 0]


@pytest.mark.parametrize(
    ("estimate", "advice"),
    [
        (walk_at(START_S + np.arange(3.0)).times_s * 1e3, "look like milliseconds"),
        (walk_at(START_S + np.arange(3.0)).times_s * 1e6, "look like microseconds"),
        (walk_at(START_S + np.arange(3.0)).times_s * 1e9, "look like nanoseconds"),
        (np.arange(3.0), "counts from 1970 and the other from its own start"),
        (START_S + np.arange(3.0) + 7200.0, "time_offset_s=-7200"),
        (START_S + np.arange(3.0) - 18.0, "time_offset_s=18.000"),
        (START_S + np.arange(3.0) + 500.0, "are they of the same walk"),
        (START_S + np.arange(3.0) + 0.051, "larger max_gap_s"),
    ],
)
def test_nothing_matched_says_why_and_what_to_try(estimate: np.ndarray, advice: str) -> None:
    with pytest.raises(NothingMatched, match="nothing matched") as refusal:
        associate(walk(10.0), Trajectory(estimate, np.zeros((3, 3))), AssociationOptions("nearest", max_gap_s=0.01))
    assert advice in refusal.value.detail
    assert refusal.value.fields["reference_from_s"] == START_S


def test_empty_trajectories_are_named() -> None:
    empty = Trajectory(np.zeros(0), np.zeros((0, 3)))
    with pytest.raises(NothingMatched, match="the estimate has no poses"):
        associate(walk(3.0), empty)
    for association in ("interpolate", "nearest", "last"):
        with pytest.raises(NothingMatched, match="the reference has no poses"):
            associate(empty, walk(3.0), AssociationOptions(association))  # type: ignore[arg-type]
