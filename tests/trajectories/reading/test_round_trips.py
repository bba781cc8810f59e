"""What the project writes it reads again, and other dialects as their own documents say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from app.trajectories.competition_formats import posi_text, position_log_text
from app.trajectories.formats import csv_text, geojson_text
from app.trajectories.geopose import geopose_text
from app.trajectories.reading.csv_file import read_csv
from app.trajectories.reading.euroc import read_euroc
from app.trajectories.reading.evaal import posi_table, read_position_log
from app.trajectories.reading.geojson import read_geojson
from app.trajectories.reading.geopose import read_geopose
from app.trajectories.reading.kitti import read_kitti
from app.trajectories.reading.tum import read_tum
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import START_S, walk

MICRO = 0.51e-6  # half a unit of the last written digit, and the stamp's own rounding in float64


def covariances(count: int) -> np.ndarray:
    roots = np.random.default_rng(1).normal(0.0, 1e-3, (count, 6, 6))
    return roots @ roots.transpose(0, 2, 1)


def assert_same(found: Trajectory, given_one: Trajectory, tolerance: float = MICRO) -> None:
    np.testing.assert_allclose(found.times_s, given_one.times_s, rtol=0, atol=tolerance)
    np.testing.assert_allclose(found.positions_m, given_one.positions_m, rtol=0, atol=tolerance)
    assert found.rotations is not None and given_one.rotations is not None
    np.testing.assert_allclose(found.rotations, given_one.rotations, atol=1e-8)


@given(st.integers(1, 20), st.booleans())
def test_csv_comes_back_with_its_covariances(count: int, sure: bool) -> None:
    given_one = walk(count / 10, covariances=covariances(count)) if sure else walk(count / 10)
    found = read_csv("".join(csv_text([given_one])).encode())
    assert_same(found.trajectory, given_one)
    assert found.time_unit.name == "s" and found.time_unit.detected
    if sure:
        np.testing.assert_allclose(found.trajectory.covariances, given_one.covariances, rtol=1e-6)
    else:
        assert found.trajectory.covariances is None


def test_tum_comes_back() -> None:
    assert_same(read_tum("".join(tum_text([walk(3.0)])).encode()).trajectory, walk(3.0))


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 10**3), ("us", 10**6), ("ns", 10**9)])
def test_the_unit_of_stamps_since_1970_is_seen(unit: str, factor: int) -> None:
    lines = [f"{round((START_S + step) * factor)} 1 2 3 0 0 0 1" for step in range(3)]
    found = read_tum("\n".join(lines).encode())
    assert (found.time_unit.name, found.time_unit.detected) == (unit, True)
    np.testing.assert_allclose(found.trajectory.times_s, START_S + np.arange(3), atol=1e-6)
    assert f"count {unit} since 1970" in found.time_unit.sentence


def test_a_clock_of_its_own_is_taken_in_the_formats_unit_or_the_one_asked_for() -> None:
    data = b"0 1 2 3 0 0 0 1\n100 1 2 3 0 0 0 1\n"
    own = read_tum(data)
    assert own.trajectory.times_s.tolist() == [0.0, 100.0] and not own.time_unit.detected
    assert "taken for s" in own.time_unit.sentence
    assert read_tum(data, "ms").trajectory.times_s.tolist() == [0.0, 0.1]


def test_euroc_has_nanoseconds_and_w_first() -> None:
    turn = Rotation.from_euler("z", 90, degrees=True).as_quat()
    pose = f"1.0,2.0,3.0,{turn[3]},{turn[0]},{turn[1]},{turn[2]}"
    short = f"#timestamp [ns],p_x\n1760000000000000000,{pose}\n1760000000500000000,{pose}\n"
    found = read_euroc(short.encode()).trajectory
    np.testing.assert_allclose(found.times_s, [START_S, START_S + 0.5])
    assert found.rotations is not None
    np.testing.assert_allclose(found.rotations[0] @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-12)
    whole = short.replace("3.0", "3.0").replace("\n1", "\n1").splitlines()
    states = "\n".join(line + ",0,0,0,0,0,0,0,0,0" for line in whole[1:])
    assert_same(read_euroc(states.encode()).trajectory, found)


def test_kitti_takes_its_stamps_from_a_file_of_their_own() -> None:
    given_one = walk(2.0)
    assert given_one.rotations is not None
    matrices = np.concatenate([given_one.rotations, given_one.positions_m[:, :, None]], axis=2).reshape(-1, 12)
    poses = "\n".join(" ".join(f"{value:.9e}" for value in row) for row in matrices)
    times = "\n".join(f"{time_s - START_S:.6e}" for time_s in given_one.times_s)
    assert_same(read_kitti(poses.encode(), times.encode()).trajectory, given_one.shifted(-START_S))


@pytest.mark.parametrize("separator", [",", ";", " ", "\t"])
def test_an_evaal_log_has_positions_and_storeys(separator: str) -> None:
    lines = [separator.join(["0.5", "1.5", "2.5", "0"]), separator.join(["1.0", "1.6", "2.6", "-1"])]
    found = read_position_log("\n".join(lines).encode()).trajectory
    assert found.positions_m.tolist() == [[1.5, 2.5, 0.0], [1.6, 2.6, 0.0]]
    assert found.floors is not None and found.floors.tolist() == [0, -1]
    assert found.orientations_xyzw is None


def test_the_true_positions_of_an_ipin_log() -> None:
    log = b"% comment\nWIFI;1.0;0.5;x\nPOSI;2.5;1;40.3135;-3.4834;2;1\nACCE;3;1;2\nPOSI;9.0;2;40.3136;-3.4835;2;1;\n"
    table = posi_table(log)
    assert table.column("timestamp").tolist() == [2.5, 9.0]
    assert table.lines.tolist() == [3, 5]


def test_a_csv_of_positions_needs_no_height_and_keeps_storeys_and_sigmas() -> None:
    data = b"\xef\xbb\xbftime_utc,x_m,y_m,floor,sigma_x_m,sigma_y_m,sigma_z_m\n2026-03-01T12:00:00Z,1,2,3,0.1,0.2,0.3\n"
    found = read_csv(data).trajectory
    assert found.times_s.tolist() == [1772366400.0]
    assert found.positions_m.tolist() == [[1.0, 2.0, 0.0]]
    assert found.floors is not None and found.floors.tolist() == [3]
    np.testing.assert_allclose(found.sigmas, [[0.1, 0.2, 0.3]])


def test_arrivals_come_back_in_the_unit_of_the_stamps() -> None:
    given_one = replace(walk(1.0), arrived_s=walk(1.0).times_s + 0.25)
    found = read_csv("".join(csv_text([given_one])).encode()).trajectory
    np.testing.assert_allclose(found.arrived_s, given_one.arrived_s, rtol=0, atol=MICRO)
    in_ms = read_csv(b"time_s,x_m,y_m,arrived_s\n1760000000000,1,2,1760000000250\n").trajectory
    assert in_ms.arrived_s is not None and in_ms.arrived_s.tolist() == [1_760_000_000.25]
    own_clock = read_csv(b"time_ms,x_m,y_m,arrived_ms\n500,1,2,750\n").trajectory
    assert own_clock.arrived_s is not None and own_clock.arrived_s.tolist() == [0.75]
    named = read_csv(b"time_s,x_m,y_m,arrived_us\n5,1,2,5250000\n").trajectory
    assert named.arrived_s is not None and named.arrived_s.tolist() == [5.25]


def degrees(positions_m: np.ndarray) -> np.ndarray:
    """A geodesy that is easily undone: a micrometre is 1e-9 degrees."""
    return positions_m * [1e-3, 1e-3, 1.0]


@pytest.mark.parametrize("oriented", [True, False])
def test_geojson_comes_back_with_covariances_and_arrivals(oriented: bool) -> None:
    freedoms = 6 if oriented else 3
    whole = walk(2.0, covariances=covariances(20))
    assert whole.covariances is not None
    given_one = replace(
        whole,
        orientations_xyzw=whole.orientations_xyzw if oriented else None,
        covariances=whole.covariances[:, :freedoms, :freedoms],
        floors=np.arange(20) // 10,
        arrived_s=whole.times_s + 0.125,
    )
    found = read_geojson("".join(geojson_text([given_one], degrees, {})).encode())
    np.testing.assert_allclose(found.places_deg_m, degrees(given_one.positions_m), rtol=0, atol=0.51e-4)
    np.testing.assert_allclose(found.places_deg_m[:, :2], degrees(given_one.positions_m)[:, :2], rtol=0, atol=0.51e-9)
    np.testing.assert_allclose(found.covariances, given_one.covariances, rtol=1e-6)
    np.testing.assert_allclose(found.arrived_s, given_one.arrived_s, rtol=0, atol=MICRO)
    assert found.floors is not None and found.floors.tolist() == given_one.floors.tolist()
    assert (found.orientations_xyzw is not None) == oriented


def test_geopose_comes_back() -> None:
    given_one = walk(2.0)
    text = "".join(geopose_text([given_one], degrees, np.eye(3)))
    found = read_geopose(text.encode())
    np.testing.assert_allclose(found.times_s, given_one.times_s, rtol=0, atol=0.51e-3)  # whole milliseconds
    assert found.orientations_xyzw is not None
    assert_same(
        Trajectory(given_one.times_s, found.places_deg_m / [1e-3, 1e-3, 1.0], found.orientations_xyzw), given_one, 1e-4
    )
    single = read_geopose(text.strip()[1:].split(",\n")[0].encode())
    assert len(single.times_s) == 1


def test_competition_files_come_back() -> None:
    given_one = replace(walk(2.0), floors=np.arange(20) // 10)
    log = read_position_log("".join(position_log_text([given_one])).encode()).trajectory
    np.testing.assert_allclose(log.positions_m[:, :2], given_one.positions_m[:, :2], rtol=0, atol=MICRO)
    np.testing.assert_allclose(log.times_s, given_one.times_s, rtol=0, atol=MICRO)
    assert log.floors is not None and log.floors.tolist() == given_one.floors.tolist()
    halves = [given_one.take(rows) for rows in np.array_split(np.arange(20), 2)]
    table = posi_table("".join(posi_text(halves, degrees)).encode())
    np.testing.assert_allclose(table.column("longitude"), degrees(given_one.positions_m)[:, 0], atol=0.51e-9)
    assert table.column("counter").tolist() == list(range(1, 21))
    assert "".join(position_log_text([walk(0.1)])).endswith(",0\n")
