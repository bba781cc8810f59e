from __future__ import annotations

import numpy as np
import pytest

from app.errors import InvalidInput
from app.geometry.rotation import exp_rotation
from app.trajectories.lever_arm import with_lever_arm
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import walk

ARM_M = np.array([0.1, -0.2, 0.05])


def test_a_point_fixed_to_the_camera_turns_with_it() -> None:
    trajectory = walk(5.0)
    there = with_lever_arm(trajectory, ARM_M)
    offsets_m = there.positions_m - trajectory.positions_m
    np.testing.assert_allclose(np.linalg.norm(offsets_m, axis=1), np.linalg.norm(ARM_M))
    assert trajectory.rotations is not None
    np.testing.assert_allclose(np.einsum("kji,kj->ki", trajectory.rotations, offsets_m), np.tile(ARM_M, (50, 1)))
    np.testing.assert_allclose(with_lever_arm(there, -ARM_M).positions_m, trajectory.positions_m)


def test_the_covariance_is_that_of_many_draws() -> None:
    root = np.random.default_rng(2).normal(0, 1e-3, (6, 6))
    trajectory = walk(0.1, covariances=(root @ root.T)[None])
    there = with_lever_arm(trajectory, ARM_M)
    assert trajectory.rotations is not None and there.covariances is not None
    draws = np.random.default_rng(4).normal(size=(200_000, 6)) @ root.T
    drawn_m = trajectory.positions_m + draws[:, :3] + exp_rotation(draws[:, 3:]) @ trajectory.rotations[0] @ ARM_M
    # Of n draws a variance has a relative standard deviation of sqrt(2 / n) = 0.3 %.
    np.testing.assert_allclose(np.cov(drawn_m.T), there.covariances[0, :3, :3], rtol=0.02, atol=2e-8)


def test_positions_alone_have_no_lever() -> None:
    with pytest.raises(InvalidInput, match="lever_arm_m"):
        with_lever_arm(Trajectory(np.zeros(1), np.zeros((1, 3))), ARM_M)
