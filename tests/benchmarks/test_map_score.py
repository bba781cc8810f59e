"""Map scores on maps whose errors are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.geometry.control import ControlPoint
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.similarity import Similarity
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.targets.layout import dots_target_m
from benchmarks.map_score import DATUM_DOF, TARGET_DOF, score_map

U_M = 0.014
SIGMA_M, SIGMA_RAD = 0.0005, 0.002
DATUM_SIGMAS = np.array([0.001, 0.001, 0.001, 0.0003, 0.0003, 0.0003, 0.0002])
Array = np.ndarray


def true_poses(rng: np.random.Generator, count: int) -> dict[int, Pose]:
    return {
        code: Pose(exp_rotation(rng.normal(size=3)), rng.uniform([0, 0, 0], [10, 9, 3])) for code in range(1, count + 1)
    }


def dots_of(poses: dict[int, Pose]) -> dict[int, Array]:
    return {code: pose.apply(dots_target_m(U_M)) for code, pose in poses.items()}


def map_of(poses: dict[int, Pose]) -> TargetMap:
    own = np.diag([SIGMA_M**2] * 3 + [SIGMA_RAD**2] * 3)
    targets = tuple(
        MappedTarget(code, pose, pose.apply(dots_target_m(U_M)), own, 5, 0.1) for code, pose in poses.items()
    )
    return TargetMap(targets, Datum(np.array([5.0, 4.5, 1.5]), np.diag(DATUM_SIGMAS**2)), "golay", U_M)


def control_of(dots_m: dict[int, Array], codes: tuple[int, ...], noise_m: Array) -> list[ControlPoint]:
    return [
        ControlPoint(f"P{code}", code, "A", dots_m[code][0] + noise, 0.001, "control")
        for code, noise in zip(codes, noise_m, strict=True)
    ]


def test_a_perfect_map_has_no_error_and_the_floor_is_the_controls() -> None:
    rng = np.random.default_rng(1)
    poses = true_poses(rng, 30)
    dots_m = dots_of(poses)
    noise_m = rng.normal(scale=0.001, size=(4, 3))
    score = score_map(map_of(poses), dots_m, control_of(dots_m, (1, 2, 3, 4), noise_m))
    assert score.targets == 30
    assert score.shape_rmse_m == pytest.approx(0.0, abs=1e-9)
    assert score.absolute_rmse_m == pytest.approx(0.0, abs=1e-9)
    assert score.floor_rmse_m is not None
    assert 0.0003 < score.floor_rmse_m < 0.01


def test_a_moved_map_keeps_its_shape() -> None:
    poses = true_poses(np.random.default_rng(2), 30)
    shift_m = np.array([0.003, 0.0, 0.004])
    moved = {code: Pose(pose.rotation, pose.position_m + shift_m) for code, pose in poses.items()}
    score = score_map(map_of(moved), dots_of(poses), [])
    assert score.shape_rmse_m == pytest.approx(0.0, abs=1e-9)
    assert score.absolute_rmse_m == pytest.approx(0.005)
    assert score.floor_rmse_m is None
    assert score.datum_nees == pytest.approx(np.sum((shift_m / DATUM_SIGMAS[:3]) ** 2))


def test_the_floor_is_reached_by_a_perfect_map_on_its_control() -> None:
    """Without noise in the control the floor is zero, and a map that is turned as the control says reaches it."""
    poses = true_poses(np.random.default_rng(3), 30)
    dots_m = dots_of(poses)
    score = score_map(map_of(poses), dots_m, control_of(dots_m, (1, 2, 3, 4, 5), np.zeros((5, 3))))
    assert score.floor_rmse_m == pytest.approx(0.0, abs=1e-9)


def test_normalised_errors_of_noise_as_claimed() -> None:
    """300 targets moved by noise of their own covariance: the mean of chi-squared of six, less the seven of the fit."""
    rng = np.random.default_rng(4)
    poses = true_poses(rng, 300)
    noisy = {
        code: pose.moved(np.concatenate([rng.normal(scale=SIGMA_M, size=3), rng.normal(scale=SIGMA_RAD, size=3)]))
        for code, pose in poses.items()
    }
    score = score_map(map_of(noisy), dots_of(poses), [])
    sigma_of_mean = np.sqrt(2.0 * TARGET_DOF / 300)
    assert score.target_nees == pytest.approx(TARGET_DOF - DATUM_DOF / 300, abs=4.0 * sigma_of_mean)


def test_normalised_errors_of_the_datum_as_claimed() -> None:
    """A map in a datum that is off by noise as claimed: chi-squared of seven, averaged over 40 draws."""
    rng = np.random.default_rng(5)
    poses = true_poses(rng, 20)
    dots_m = dots_of(poses)
    found = []
    for _ in range(40):
        error = rng.normal(scale=DATUM_SIGMAS)
        origin_m = np.array([5.0, 4.5, 1.5])
        scale, rotation = np.exp(error[6]), exp_rotation(error[3:6])
        true_from_map = Similarity(scale, rotation, origin_m + error[:3] - scale * rotation @ origin_m)
        truth = {code: true_from_map.apply(dots) for code, dots in dots_m.items()}
        found.append(score_map(map_of(poses), truth, []).datum_nees)
    assert np.mean(found) == pytest.approx(DATUM_DOF, abs=4.0 * np.sqrt(2.0 * DATUM_DOF / 40))
