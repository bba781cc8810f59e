from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.rotation import log_rotation
from app.trajectories.interpolation import find_between, interpolate
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import START_S, walk, walk_at


def test_at_its_own_stamps_a_trajectory_is_itself() -> None:
    trajectory = walk(5.0)
    for course in ("linear", "spline"):
        again = interpolate(trajectory, trajectory.times_s, 0.5, course)
        np.testing.assert_array_equal(again.times_s, trajectory.times_s)
        np.testing.assert_allclose(again.positions_m, trajectory.positions_m, atol=1e-14)
        np.testing.assert_allclose(again.rotations, trajectory.rotations, atol=1e-12)


@pytest.mark.parametrize(("course", "order"), [("linear", 2), ("spline", 3)])
def test_the_error_falls_with_the_step_as_the_theory_says(course: str, order: int) -> None:
    """Linear interpolation errs by h^2 |a| / 8, the Hermite cubic with parabolas' slopes by the third power of h."""
    errors_m = []
    for rate_hz in (2.0, 4.0, 8.0):
        trajectory = walk(40.0, rate_hz)
        times_s = START_S + np.linspace(2.0, 36.0, 777)
        between = interpolate(trajectory, times_s, 1.0, course)  # type: ignore[arg-type]
        errors_m.append(np.abs(between.positions_m - walk_at(times_s).positions_m).max())
    assert errors_m[0] / errors_m[1] > 0.8 * 2**order
    assert errors_m[1] / errors_m[2] > 0.8 * 2**order
    if course == "linear":
        greatest_m_s2 = 4.0 * 0.31**2 + 2.0 * 0.62**2
        assert errors_m[0] < greatest_m_s2 * 0.5**2 / 8


def test_orientations_turn_evenly() -> None:
    trajectory = Trajectory(
        np.array([0.0, 1.0]), np.zeros((2, 3)), np.array([[0, 0, 0, 1.0], [0, 0, np.sin(0.5), np.cos(0.5)]])
    )
    there = interpolate(trajectory, np.array([0.25]), 1.0)
    assert there.rotations is not None
    np.testing.assert_allclose(log_rotation(there.rotations[0]), [0.0, 0.0, 0.25], atol=1e-12)


def test_gaps_are_not_bridged_and_nothing_is_told_beyond_the_ends() -> None:
    trajectory = walk_at(START_S + np.array([0.0, 0.5, 3.0, 3.5]))
    times_s = START_S + np.array([-0.1, 0.0, 0.2, 0.5, 1.0, 2.9, 3.0, 3.2, 3.5, 3.6])
    inside = find_between(trajectory.times_s, times_s, 0.6).inside
    assert inside.tolist() == [False, True, True, True, False, False, True, True, True, False]
    assert len(interpolate(trajectory, times_s, 0.6, "spline")) == 6


def test_a_spline_does_not_swing_before_a_gap() -> None:
    """On either side of a gap the course is that of the poses on that side."""
    still = Trajectory(np.array([0.0, 0.5, 9.0, 9.5]), np.array([[0, 0, 0], [0, 0, 0], [50, 0, 0], [50, 0, 0]], float))
    there = interpolate(still, np.array([0.25, 9.25]), 1.0, "spline")
    np.testing.assert_allclose(there.positions_m[:, 0], [0.0, 50.0], atol=1e-12)


@given(st.floats(0.0, 1.0))
def test_the_covariance_is_never_above_the_larger_neighbour_nor_below_the_smaller(weight: float) -> None:
    covariances = np.array([1e-6, 4e-6])[:, None, None] * np.eye(6)
    trajectory = walk_at(START_S + np.array([0.0, 1.0]), covariances)
    there = interpolate(trajectory, np.array([START_S + weight]), 1.0)
    assert there.covariances is not None
    assert 1e-6 * (1 - 1e-9) <= there.covariances[0, 0, 0] <= 4e-6 * (1 + 1e-9)


def test_floors_are_those_of_the_nearer_pose() -> None:
    trajectory = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 3)), floors=np.array([0, 1]))
    floors = interpolate(trajectory, np.array([0.2, 0.8]), 1.0).floors
    assert floors is not None
    assert floors.tolist() == [0, 1]


def test_an_empty_trajectory_tells_nothing() -> None:
    empty = Trajectory(np.zeros(0), np.zeros((0, 3)))
    assert len(interpolate(empty, np.array([1.0]), 1.0)) == 0
