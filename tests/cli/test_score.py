"""Scores are what the paper's table 4 defines, on errors that are known."""

from __future__ import annotations

import numpy as np
import pytest

from app.cli.score import Located, rmse_of, rmse_of_scores, score_snapshot, score_to_json
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation


def test_rmse_per_axis_in_the_plane_and_in_space() -> None:
    rmse = rmse_of(np.array([[3.0, 4.0, 0.0], [-3.0, 4.0, 12.0]]))
    assert (rmse.x_m, rmse.y_m) == (3.0, 4.0)
    assert rmse.xy_m == pytest.approx(5.0)
    assert rmse.z_m == pytest.approx(np.sqrt(72.0))
    assert rmse.xyz_m == pytest.approx(np.sqrt(25.0 + 72.0))


def test_an_error_is_estimate_minus_truth() -> None:
    truth = Pose(np.eye(3), np.array([1.0, 2.0, 3.0]))
    turned = exp_rotation(np.array([0.0, 0.0, np.radians(0.5)]))
    sigma_m = np.array([0.001, 0.001, 0.002])
    score = score_snapshot(Located("a.jpg", Pose(turned, np.array([1.1, 2.0, 2.8])), sigma_m), truth)
    assert score.error_m == pytest.approx([0.1, 0.0, -0.2])
    assert score.angle_deg == pytest.approx(0.5)
    record = score_to_json(score)
    assert record["distance_m"] == pytest.approx(np.sqrt(0.05))
    assert record["sigma_m"] == [0.001, 0.001, 0.002]


def test_refused_snapshots_do_not_count_and_keep_their_reason() -> None:
    truth = Pose(np.eye(3), np.zeros(3))
    refused = score_snapshot(Located("a.jpg", reason="no-targets"), truth)
    found = score_snapshot(Located("b.jpg", Pose(np.eye(3), np.array([0.0, 0.0, 0.3])), np.zeros(3)), truth)
    rmse = rmse_of_scores([refused, found])
    assert rmse is not None
    assert rmse.xyz_m == pytest.approx(0.3)
    assert score_to_json(refused)["reason"] == "no-targets"
    assert rmse_of_scores([refused]) is None
