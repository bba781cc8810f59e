from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.trajectories.trajectory import Trajectory

COUNT = 3


def arrays() -> dict[str, Any]:
    return {
        "times_s": np.array([1.0, 2.0, 2.0]),
        "positions_m": np.arange(9.0).reshape(3, 3),
        "orientations_xyzw": np.tile([0.0, 0.6, 0.0, 0.8], (3, 1)),
        "covariances": np.tile(np.diag([1.0, 4.0, 9.0, 16.0, 25.0, 36.0]) * 1e-6, (3, 1, 1)),
    }


def test_sigmas_are_the_roots_of_the_diagonals() -> None:
    trajectory = Trajectory(**arrays())
    assert len(trajectory) == COUNT
    np.testing.assert_allclose(trajectory.sigmas, np.tile([1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3], (3, 1)))
    assert Trajectory(**{**arrays(), "covariances": None}).sigmas is None


def test_no_poses_are_a_trajectory_too() -> None:
    assert len(Trajectory(np.empty(0), np.empty((0, 3)), np.empty((0, 4)), np.empty((0, 6, 6)))) == 0


@pytest.mark.parametrize(
    ("name", "value", "what"),
    [
        ("times_s", np.array([1.0, 2.0, 1.5]), "decrease"),
        ("times_s", np.array([1.0, 2.0, np.inf]), "finite"),
        ("times_s", np.ones((3, 1)), "shape"),
        ("positions_m", np.zeros((2, 3)), "shape"),
        ("positions_m", np.full((3, 3), np.nan), "finite"),
        ("orientations_xyzw", np.ones((3, 4)), "unit"),
        ("orientations_xyzw", np.ones((3, 3)), "shape"),
        ("covariances", np.zeros((3, 3, 3)), "shape"),
    ],
)
def test_what_is_no_trajectory_is_refused(name: str, value: np.ndarray, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        Trajectory(**{**arrays(), name: value})
