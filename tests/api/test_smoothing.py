"""The truth between snapshots over HTTP."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.trajectories.formats import csv_text
from app.trajectories.reading.any_file import read_trajectory
from tests.api.serving import Served, assert_problem
from tests.api.test_trajectory_import import imported
from tests.trajectories.walks import START_S, walk, walk_at


@pytest.fixture(scope="module")
def path(served: Served) -> str:
    """A walk of ten seconds, four poses a second, with a gap of four seconds after it and another pose."""
    times_s = START_S + np.append(np.arange(0.0, 10.0, 0.25), 14.0)
    truth = walk_at(times_s, np.tile(np.diag([1e-6] * 6), (len(times_s), 1, 1)))
    trajectory_id = imported(served, "".join(csv_text([truth])), site_id=served.new_site())["trajectory_id"]
    return f"/trajectories/{trajectory_id}/smoothed"


def told(served: Served, path: str, **query: Any) -> list[dict[str, Any]]:
    answer = served.client.get(path, params=query)
    assert answer.status_code == 200, answer.text
    poses: list[dict[str, Any]] = answer.json()["poses"]
    return poses


def test_poses_at_a_rate_with_gaps_left_out(served: Served, path: str) -> None:
    poses = told(served, path, rate_hz=10)
    assert len(poses) == 99  # to 9.75 s, and the last pose itself
    truth = walk_at(START_S + np.append(np.arange(98) / 10, 14.0))
    np.testing.assert_allclose([pose["position_m"] for pose in poses], truth.positions_m, atol=0.02)
    sigmas_m = [max(pose["position_sigma_m"]) for pose in poses]
    assert sigmas_m[4] > 5 * sigmas_m[5]  # 0.4 s lies between two looks, 0.5 s at one


def test_poses_at_moments(served: Served, path: str) -> None:
    moments = f"{START_S + 1.1},{START_S + 1.2},{START_S + 12.0}"
    assert len(told(served, path, times=moments)) == 2
    assert told(served, path, times=str(START_S + 1.1), to=START_S + 1.0) == []


def test_smoothed_as_a_file(served: Served, path: str) -> None:
    text = served.client.get(path, params={"rate_hz": 2, "format": "tum"}).text
    assert len(read_trajectory(text.encode()).trajectory) == 21


@pytest.mark.parametrize(
    "query",
    [
        {},
        {"rate_hz": 1, "times": "1"},
        {"rate_hz": 0},
        {"times": "2,1"},
        {"times": "noon"},
        {"rate_hz": 1000, "max_gap_s": 0},
    ],
)
def test_a_wrong_wish_is_told(served: Served, path: str, query: dict[str, Any]) -> None:
    assert_problem(served.client.get(path, params=query), 422, "invalid-input")


def test_a_long_range_at_a_high_rate_is_too_much(served: Served) -> None:
    times_s = START_S + np.array([0.0, 1e6])
    far = walk_at(times_s, np.tile(np.diag([1e-6] * 6), (2, 1, 1)))
    trajectory_id = imported(served, "".join(csv_text([far])), site_id=served.new_site())["trajectory_id"]
    answer = served.client.get(f"/trajectories/{trajectory_id}/smoothed", params={"rate_hz": 1000})
    assert "shorter range" in assert_problem(answer, 422, "invalid-input")["detail"]


def test_it_takes_covariances(served: Served) -> None:
    bare = imported(served, "".join(csv_text([walk(2.0)])), site_id=served.new_site())["trajectory_id"]
    answer = served.client.get(f"/trajectories/{bare}/smoothed", params={"rate_hz": 1})
    assert "covariances" in assert_problem(answer, 409, "conflict")["detail"]
