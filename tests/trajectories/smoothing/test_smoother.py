from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from app.errors import InvalidInput
from app.geometry.rotation import exp_rotation, log_rotation
from app.trajectories.smoothing.motion import MotionOptions, left_jacobian
from app.trajectories.smoothing.smoother import SmootherOptions, smooth_at
from app.trajectories.trajectory import Array, Trajectory
from tests.trajectories.walks import START_S, walk, walk_at

SIGMAS = np.array([0.002, 0.002, 0.003, 0.001, 0.001, 0.001])
MOTION = MotionOptions()


def measured(true: Trajectory, seed: int) -> Trajectory:
    """A trajectory as snapshots would tell it."""
    noise = np.random.default_rng(seed).normal(size=(len(true), 6)) * SIGMAS
    assert true.rotations is not None
    rotations = exp_rotation(noise[:, 3:]) @ true.rotations
    covariances = np.tile(np.diag(SIGMAS**2), (len(true), 1, 1))
    return Trajectory(
        true.times_s,
        true.positions_m + noise[:, :3],
        Rotation.from_matrix(rotations).as_quat(canonical=True),
        covariances,
    )


def shaken_walk(seconds: float, step_s: float, seed: int) -> Trajectory:
    """A walk drawn from the model itself: white accelerations, integrated in fine steps."""
    random, count = np.random.default_rng(seed), round(seconds / step_s)
    kicks = random.normal(size=(count, 6)) * np.sqrt(MOTION.densities * step_s)
    velocities = np.cumsum(np.vstack([random.normal(size=6) * [1, 1, 0.2, 0.3, 0.3, 0.5], kicks]), axis=0)
    between = (velocities[1:] + velocities[:-1]) / 2
    positions_m = np.cumsum(np.vstack([np.zeros(3), step_s * between[:, :3]]), axis=0)
    rotations = [np.eye(3)]
    for rate in between[:, 3:]:
        rotations.append(exp_rotation(step_s * rate) @ rotations[-1])
    times_s = START_S + step_s * np.arange(count + 1)
    return Trajectory(times_s, positions_m, Rotation.from_matrix(np.array(rotations)).as_quat(canonical=True))


def normalised_squares(found: Trajectory, true: Trajectory) -> Array:
    """``e^T C^-1 e`` of each pose, shape (K,): 6 on average when the covariances are honest."""
    assert found.rotations is not None and true.rotations is not None and found.covariances is not None
    turn = log_rotation(true.rotations @ found.rotations.transpose(0, 2, 1))
    errors = np.hstack([true.positions_m - found.positions_m, turn])
    return np.einsum("ki,ki->k", errors, np.linalg.solve(found.covariances, errors[:, :, None])[:, :, 0])


def test_on_walks_of_the_model_the_errors_are_those_that_the_covariances_promise() -> None:
    """Some 16 x 27 nearly independent gaps of 6 components: the mean scatters by 6 sqrt(2 / (6 432)) = 0.17."""
    at_the_middle, at_poses = [], []
    for seed in range(16):
        true = shaken_walk(28.0, 0.02, seed)
        seen = np.arange(0, len(true), 50)  # one look a second
        middles, poses = seen[:-1] + 25, seen[1:-1]
        for rows, found in ((middles, at_the_middle), (poses, at_poses)):
            smoothed = smooth_at(measured(true.take(seen), seed), true.times_s[rows])
            found.append(normalised_squares(smoothed, true.take(rows)).mean())
    assert np.mean(at_the_middle) == pytest.approx(6.0, abs=0.7)
    assert np.mean(at_poses) == pytest.approx(6.0, abs=0.7)


def test_a_smooth_walk_is_met_better_than_promised_never_worse() -> None:
    true = walk(60.0, 1.0)
    times_s = START_S + np.arange(1.05, 58.0, 0.25)
    smoothed = smooth_at(measured(true, 3), times_s)
    assert len(smoothed) == len(times_s)
    assert normalised_squares(smoothed, walk_at(times_s)).mean() < 6.0


def test_uncertainty_grows_away_from_the_poses() -> None:
    smoothed = smooth_at(measured(walk(10.0, 1.0), 1), START_S + np.arange(2.0, 7.0, 0.25))
    assert smoothed.sigmas is not None
    sigma_m = smoothed.sigmas[:, 0].reshape(-1, 4)
    assert (sigma_m[:, 2] > sigma_m[:, 1]).all() and (sigma_m[:, 1] > 5 * sigma_m[:, 0]).all()
    assert (sigma_m[:, 0] <= SIGMAS[0]).all()  # neighbours can only add to what a look tells


def test_it_refuses_across_gaps() -> None:
    true = walk(20.0, 1.0).take(np.array([0, 1, 2, 8, 9, 15]))
    asked = START_S + np.array([-1.0, 0.5, 2.0, 5.0, 8.5, 12.0, 15.0, 15.5])
    smoothed = smooth_at(measured(true, 2), asked, SmootherOptions(max_gap_s=3.0))
    assert (smoothed.times_s - START_S).tolist() == [0.5, 2.0, 8.5, 15.0]
    assert len(smooth_at(measured(true, 2), START_S + np.array([5.0]))) == 0


@given(st.integers(0, 20))
def test_another_frame_changes_nothing_but_the_frame(seed: int) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    here = measured(walk(6.0, 1.0), seed)
    assert here.rotations is not None and here.covariances is not None
    both = np.kron(np.eye(2), turn)
    there = Trajectory(
        here.times_s,
        here.positions_m @ turn.T,
        Rotation.from_matrix(turn @ here.rotations).as_quat(canonical=True),
        both @ here.covariances @ both.T,
    )
    times_s = START_S + np.array([1.3, 2.0, 4.7])
    first, second = smooth_at(here, times_s), smooth_at(there, times_s)
    np.testing.assert_allclose(second.positions_m, first.positions_m @ turn.T, atol=1e-9)
    assert first.covariances is not None and second.covariances is not None
    np.testing.assert_allclose(second.covariances, both @ first.covariances @ both.T, atol=1e-12)


def test_the_left_jacobian_is_the_derivative_of_the_exponential() -> None:
    step = 1e-6
    for vector in (np.array([0.3, -1.2, 0.5]), np.array([1e-5, 0.0, -2e-5]), np.zeros(3)):
        numeric = [
            log_rotation(exp_rotation(vector + step * axis) @ exp_rotation(vector - step * axis).T) / (2 * step)
            for axis in np.eye(3)
        ]
        np.testing.assert_allclose(left_jacobian(vector), np.array(numeric).T, atol=1e-8)


def test_what_cannot_be_smoothed_is_refused() -> None:
    with pytest.raises(InvalidInput, match="covariances"):
        smooth_at(walk(3.0), np.array([START_S]))
    good = measured(walk(3.0, 1.0), 1)
    with pytest.raises(InvalidInput, match="times asked for"):
        smooth_at(good, np.array([START_S + 1.0, START_S + 1.0]))
    with pytest.raises(InvalidInput, match="trajectory's stamps"):
        smooth_at(good.take(np.array([0, 1, 1])), np.array([START_S]))
