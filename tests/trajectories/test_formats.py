"""What is written is read back by other readers: the csv module, json, a TUM reader of three lines."""

from __future__ import annotations

import csv
import io
import json
from datetime import datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.rotation import exp_rotation, quaternion_xyzw
from app.trajectories.formats import CSV_COLUMNS, csv_text, geojson_text, iso_times
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Trajectory

START_S = 1.78e9
LAST_S = 253_402_300_799.0  # of the year 9999
HALF_MICRO = 0.5e-6
SIGMA_DIGITS = 1e-6  # seven digits are written


def walk(count: int, seed: int = 1) -> Trajectory:
    random = np.random.default_rng(seed)
    roots = random.normal(size=(count, 6, 6)) * 1e-3
    return Trajectory(
        times_s=np.sort(START_S + random.uniform(0, 1000, count)),
        positions_m=random.normal(size=(count, 3)) * 10,
        orientations_xyzw=quaternion_xyzw(exp_rotation(random.normal(size=(count, 3)))),
        covariances=roots @ roots.transpose(0, 2, 1),
    )


def cut(trajectory: Trajectory, size: int) -> list[Trajectory]:
    assert trajectory.covariances is not None
    return [
        Trajectory(
            trajectory.times_s[start : start + size],
            trajectory.positions_m[start : start + size],
            trajectory.orientations_xyzw[start : start + size],
            trajectory.covariances[start : start + size],
        )
        for start in range(0, len(trajectory), size)
    ]


def assert_poses(rows: np.ndarray, trajectory: Trajectory) -> None:
    """Rows of time, position and quaternion, as far as their digits go."""
    np.testing.assert_allclose(rows[:, 0], trajectory.times_s, rtol=0, atol=2 * HALF_MICRO)
    np.testing.assert_allclose(rows[:, 1:4], trajectory.positions_m, rtol=0, atol=1.01 * HALF_MICRO)
    np.testing.assert_allclose(rows[:, 4:8], trajectory.orientations_xyzw, rtol=0, atol=0.51e-9)


@pytest.mark.parametrize("size", [1, 4, 100])
def test_tum_is_eight_numbers_a_line(size: int) -> None:
    trajectory = walk(10)
    rows = np.loadtxt(io.StringIO("".join(tum_text(cut(trajectory, size)))))
    assert_poses(rows, trajectory)


@pytest.mark.parametrize("size", [1, 4, 100])
def test_csv_has_a_heading_and_a_line_per_pose(size: int) -> None:
    trajectory = walk(10)
    lines = list(csv.DictReader(io.StringIO("".join(csv_text(cut(trajectory, size))))))
    assert tuple(lines[0]) == CSV_COLUMNS
    rows = np.array([[float(line[name]) for name in CSV_COLUMNS[1:]] for line in lines])
    assert_poses(rows[:, :8], trajectory)
    assert trajectory.sigmas is not None
    np.testing.assert_allclose(rows[:, 8:14], trajectory.sigmas, rtol=SIGMA_DIGITS)
    assert trajectory.covariances is not None
    upper = trajectory.covariances[:, *np.triu_indices(6)]
    np.testing.assert_allclose(rows[:, 14:], upper, rtol=SIGMA_DIGITS)
    for line in lines:
        assert datetime.fromisoformat(line["time_utc"]).timestamp() == pytest.approx(float(line["time_s"]), abs=1e-6)


def test_what_is_not_known_stays_empty_in_csv() -> None:
    full = walk(2)
    text = "".join(csv_text([Trajectory(full.times_s, full.positions_m, full.orientations_xyzw)]))
    lines = list(csv.DictReader(io.StringIO(text), strict=True))
    assert [line["sigma_x_m"] for line in lines] == ["", ""]
    assert None not in lines[0]  # no more cells than columns


@pytest.mark.parametrize("size", [1, 4, 100])
def test_geojson_is_one_collection_however_it_is_cut(size: int) -> None:
    trajectory = walk(10)
    members = {"trajectory_id": "t"}
    text = "".join(geojson_text(cut(trajectory, size), lambda site_m: site_m * 2.0, members))
    collection = json.loads(text)
    assert (collection["type"], collection["trajectory_id"], len(collection["features"])) == (
        "FeatureCollection",
        "t",
        10,
    )
    places = np.array([feature["geometry"]["coordinates"] for feature in collection["features"]])
    np.testing.assert_allclose(places, trajectory.positions_m * 2.0, rtol=0, atol=0.51e-4)
    properties = collection["features"][3]["properties"]
    assert trajectory.sigmas is not None
    np.testing.assert_allclose(properties["position_sigma_m"], trajectory.sigmas[3, :3])
    np.testing.assert_allclose(properties["position_m"], trajectory.positions_m[3], rtol=0, atol=1.01 * HALF_MICRO)
    assert properties["time"] == iso_times(trajectory.times_s)[3]


def test_nothing_is_an_empty_file() -> None:
    assert "".join(tum_text([])) == ""
    assert "".join(csv_text([])).splitlines() == [",".join(CSV_COLUMNS)]
    assert json.loads("".join(geojson_text([], lambda site_m: site_m, {})))["features"] == []


@given(st.floats(0.0, LAST_S))
def test_a_time_is_written_to_the_microsecond(time_s: float) -> None:
    (text,) = iso_times(np.array([time_s]))
    assert text.endswith("Z")
    # A double of the year 9999 resolves 30 microseconds.
    assert datetime.fromisoformat(text).timestamp() == pytest.approx(time_s, abs=4e-5, rel=0)
