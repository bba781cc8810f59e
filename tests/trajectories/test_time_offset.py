from __future__ import annotations

import numpy as np
import pytest

from app.errors import DegenerateGeometry
from app.trajectories.alignment import AlignmentOptions
from app.trajectories.association import AssociationOptions
from app.trajectories.no_match import NothingMatched
from app.trajectories.time_offset import OffsetOptions, estimate_time_offset
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import START_S, noisy, walk, walk_at

SMOOTH = AssociationOptions(course="spline")
NEAR = OffsetOptions(greatest_s=5.0)


@pytest.mark.parametrize("kind", ["none", "se3", "posyaw", "sim3"])
@pytest.mark.parametrize("offset_s", [-3.3, 0.0, 1.234])
def test_a_shifted_clock_is_found(kind: str, offset_s: float) -> None:
    estimate = walk(40.0, 4.0).shifted(-offset_s)
    found = estimate_time_offset(walk(60.0, 10.0), estimate, SMOOTH, AlignmentOptions(kind), NEAR)  # type: ignore[arg-type]
    assert found.offset_s == pytest.approx(offset_s, abs=2e-3)


def test_the_sigma_is_that_of_the_errors_seen() -> None:
    """Normalised errors of 30 draws: their mean square has a standard deviation of sqrt(2 / 30) = 0.26."""
    reference, squares = walk(40.0, 5.0), []
    for seed in range(30):
        estimate = noisy(walk_at(START_S + np.arange(1.0, 38.0, 0.5)), 0.1, seed).shifted(-0.7)
        found = estimate_time_offset(
            reference, estimate, SMOOTH, AlignmentOptions("se3"), OffsetOptions(greatest_s=1.0)
        )
        squares.append(((found.offset_s - 0.7) / found.sigma_s) ** 2)
    assert 0.4 < np.mean(squares) < 2.0


def test_a_straight_walk_at_an_even_pace_tells_no_offset() -> None:
    times_s = START_S + np.arange(0.0, 20.0, 0.5)
    line = Trajectory(times_s, np.outer(times_s - START_S, [1.0, 0.5, 0.0]))
    with pytest.raises(DegenerateGeometry, match="tells no offset"):
        estimate_time_offset(line, line, SMOOTH, AlignmentOptions("posyaw"), NEAR)
    known_frame = estimate_time_offset(line, line.shifted(0.5), SMOOTH, AlignmentOptions("none"), NEAR)
    assert known_frame.offset_s == pytest.approx(-0.5, abs=1e-3)


def test_walks_of_different_days_stay_apart() -> None:
    with pytest.raises(NothingMatched):
        estimate_time_offset(walk(10.0), walk(10.0).shifted(86_400.0), SMOOTH, AlignmentOptions("none"), NEAR)
