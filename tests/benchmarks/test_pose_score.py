"""Pose scores on poses whose errors are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from benchmarks.pose_score import POSE_DOF, EstimatedPose, score_poses

SIGMAS = np.array([0.001, 0.002, 0.003, 0.0005, 0.001, 0.0002])


def test_normalised_errors_of_noise_as_claimed() -> None:
    rng = np.random.default_rng(1)
    count = 400
    truth = {str(k): Pose(exp_rotation(rng.normal(size=3)), rng.normal(size=3)) for k in range(count)}
    covariance = np.diag(SIGMAS**2)
    # The convention: true = estimated moved by an error with that covariance; the noise is drawn the other way round.
    estimated = [EstimatedPose(name, pose.moved(rng.normal(scale=SIGMAS)), covariance) for name, pose in truth.items()]
    score = score_poses(estimated, truth)
    assert score is not None
    assert score.nees_mean == pytest.approx(POSE_DOF, abs=4.0 * np.sqrt(2.0 * POSE_DOF / count))
    expected_m = np.linalg.norm(SIGMAS[:3])
    assert score.sigma_rms_m == pytest.approx(expected_m)
    assert score.rmse.xyz_m == pytest.approx(expected_m, rel=0.15)
    assert score.worst_m > score.rmse.xyz_m


def test_no_pose_is_no_score() -> None:
    assert score_poses([], {}) is None
