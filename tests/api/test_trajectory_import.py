"""Trajectories of other systems over HTTP: as files in, found and read as located ones, as files out."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from app.storage.models import ImportedPosesRow, TrajectoryRow
from app.trajectories.formats import csv_text
from app.trajectories.reading.any_file import read_trajectory
from app.trajectories.reading.kitti import read_kitti
from app.trajectories.robotics_formats import kitti_times_text, tum_text
from app.trajectories.trajectory import Trajectory
from tests.api.serving import Served, assert_problem
from tests.trajectories.walks import START_S, walk

ANCHOR = {"latitude_deg": 48.15, "longitude_deg": 11.57, "height_m": 515.0, "azimuth_deg": 30.0}
PAPER = Path(__file__).parents[2] / "examples" / "paper"


def imported(served: Served, content: str | bytes, **query: str) -> dict[str, Any]:
    answer = served.client.post("/trajectories/import", params=query, content=content)
    assert answer.status_code == 201, answer.text
    taken: dict[str, Any] = answer.json()
    return taken


def exported(served: Served, trajectory_id: str, wanted: str, **query: str) -> str:
    answer = served.client.get(f"/trajectories/{trajectory_id}", params={"format": wanted, **query})
    assert answer.status_code == 200, answer.text
    return answer.text


def anchored_site(served: Served) -> str:
    site_id = served.new_site()
    assert served.client.patch(f"/sites/{site_id}", json={"geo_anchor": ANCHOR}).status_code == 200
    return site_id


@pytest.fixture(scope="module")
def site_id(served: Served) -> str:
    return anchored_site(served)


@pytest.fixture(scope="module")
def tum_id(served: Served, site_id: str) -> str:
    """A walk of ten seconds, ten poses a second."""
    return str(imported(served, "".join(tum_text([walk(10.0)])), site_id=site_id, name="walk")["trajectory_id"])


def test_what_was_found_out_is_said(served: Served, site_id: str) -> None:
    stamps_ms = "".join(f"{(START_S + second) * 1e3:.0f} {second} 2 1.5 0 0 0 1\n" for second in range(3))
    taken = imported(served, stamps_ms, site_id=site_id)
    assert (taken["poses"], taken["format"], taken["time_unit"]) == (3, "tum", "ms")
    assert "ms since 1970" in taken["note"]
    plain = imported(served, (PAPER / "truth.csv").read_bytes(), site_id=site_id, time_unit="s")
    assert (plain["poses"], plain["format"]) == (20, "csv")


def test_an_imported_trajectory_is_found_and_read_as_a_located_one(served: Served, tum_id: str) -> None:
    path = f"/trajectories/{tum_id}"
    first = served.client.get(path, params={"limit": 60}).json()
    assert (first["pose_count"], first["failure_count"], len(first["poses"])) == (100, 0, 60)
    assert (first["name"], first["source"]["format"], first["source"]["oriented"]) == ("walk", "tum", True)
    assert first["closed_at"] is not None
    rest = served.client.get(path, params={"limit": 60, "cursor": first["next_cursor"]}).json()
    assert [pose["ordinal"] for pose in first["poses"] + rest["poses"]] == list(range(1, 101))
    assert rest["next_cursor"] is None
    np.testing.assert_allclose(
        [pose["position_m"] for pose in first["poses"] + rest["poses"]], walk(10.0).positions_m, atol=1e-6
    )
    part = served.client.get(path, params={"from": START_S + 2.0, "to": START_S + 3.0}).json()
    assert len(part["poses"]) == 10


def test_filters_find_it(served: Served, site_id: str, tum_id: str) -> None:
    def found(**query: Any) -> bool:
        listed = served.client.get("/trajectories", params={"site_id": site_id, **query}).json()["trajectories"]
        return tum_id in {item["trajectory_id"] for item in listed}

    assert found()
    assert found(**{"from": START_S + 5.0, "to": START_S + 6.0})
    assert not found(to=START_S - 1.0)
    assert found(bbox="0,0,1,1")
    assert not found(bbox="50,50,60,60")
    assert not found(max_sigma_m=10.0)  # it tells none


def test_its_stream_is_over_at_once(served: Served, tum_id: str) -> None:
    with served.client.stream("GET", f"/trajectories/{tum_id}/events") as stream:
        text = "".join(stream.iter_text())
    assert "event: closed" in text


def test_it_takes_no_snapshots_and_goes_with_its_poses(served: Served, site_id: str) -> None:
    trajectory_id = imported(served, "0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n", site_id=site_id)["trajectory_id"]
    assert served.client.post(f"/trajectories/{trajectory_id}/close").status_code == 200
    assert served.client.delete(f"/trajectories/{trajectory_id}").status_code == 204
    with served.services.database.reading() as session:
        assert session.query(ImportedPosesRow).filter_by(trajectory_id=trajectory_id).count() == 0


@pytest.mark.parametrize("wanted", ["tum", "euroc", "csv"])
def test_what_goes_out_comes_in_again(served: Served, site_id: str, tum_id: str, wanted: str) -> None:
    text = exported(served, tum_id, wanted)
    again = imported(served, text, site_id=site_id)
    assert (again["format"], again["poses"]) == (wanted, 100)
    assert exported(served, again["trajectory_id"], wanted) == text


def test_kitti_takes_two_files(served: Served, site_id: str, tum_id: str) -> None:
    poses, times = exported(served, tum_id, "kitti"), exported(served, tum_id, "kitti-times")
    read = read_kitti(poses.encode(), times.encode()).trajectory
    np.testing.assert_allclose(read.positions_m, walk(10.0).positions_m, atol=1e-6)
    np.testing.assert_allclose(read.orientations_xyzw, walk(10.0).orientations_xyzw, atol=1e-8)
    answer = served.client.post(
        "/trajectories/import", data={"site_id": site_id, "name": "k"}, files={"file": poses, "times": times}
    )
    assert answer.status_code == 201, answer.text
    assert (answer.json()["format"], answer.json()["poses"]) == ("kitti", 100)
    assert exported(served, answer.json()["trajectory_id"], "kitti-times") == times
    assert times == "".join(kitti_times_text([walk(10.0)]))


def test_geojson_comes_back_to_the_site_frame(served: Served, site_id: str, tum_id: str) -> None:
    again = imported(served, exported(served, tum_id, "geojson"), site_id=site_id)
    assert again["format"] == "geojson"
    there = read_trajectory(exported(served, again["trajectory_id"], "tum").encode()).trajectory
    np.testing.assert_allclose(there.positions_m, walk(10.0).positions_m, atol=2e-4)  # degrees are written to 0.1 mm
    np.testing.assert_allclose(there.orientations_xyzw, walk(10.0).orientations_xyzw, atol=1e-8)


def test_true_positions_of_an_ipin_log_stand_in_the_site(served: Served, site_id: str) -> None:
    log = "% a log\nACCE;0.1;0.1;1;2;3;1\nPOSI;1.0;1;48.15;11.57;0;0\nPOSI;2.5;2;48.1501;11.57;1;0\n"
    taken = imported(served, log, site_id=site_id)
    assert (taken["poses"], taken["format"]) == (2, "evaal")
    poses = served.client.get(f"/trajectories/{taken['trajectory_id']}").json()["poses"]
    assert [pose["floor"] for pose in poses] == [0, 1]
    assert poses[0]["orientation_xyzw"] is None
    np.testing.assert_allclose(poses[0]["position_m"], 0.0, atol=1e-9)
    north_m = np.linalg.norm(poses[1]["position_m"])
    assert north_m == pytest.approx(11.12, abs=0.01)  # 1e-4 degrees of latitude
    assert poses[1]["position_m"][0] == pytest.approx(-north_m * 0.5)  # y points 30 degrees to the east of north


def test_geopose_turns_the_camera_against_east_north_up(served: Served, site_id: str) -> None:
    taken = imported(served, f"{START_S} 0 0 2 0 0 0 1\n", site_id=site_id)
    (pose,) = json.loads(exported(served, taken["trajectory_id"], "geopose"))
    assert pose["position"] == {"lat": 48.15, "lon": 11.57, "h": 517.0}
    assert pose["validTime"] == START_S * 1e3
    half_rad = np.radians(-15.0)  # the site's y axis is 30 degrees clockwise from north
    np.testing.assert_allclose([pose["quaternion"][name] for name in "zw"], [np.sin(half_rad), np.cos(half_rad)])


@pytest.mark.parametrize(("wanted", "atol_s"), [("geopose", 0.6e-3), ("evaal", 1e-6), ("posi", 1e-6)])
def test_files_of_other_worlds_come_back(served: Served, site_id: str, tum_id: str, wanted: str, atol_s: float) -> None:
    again = imported(served, exported(served, tum_id, wanted), site_id=site_id)
    assert again["format"] == ("geopose" if wanted == "geopose" else "evaal")
    there = read_trajectory(exported(served, again["trajectory_id"], "csv").encode()).trajectory
    np.testing.assert_allclose(there.times_s, walk(10.0).times_s, rtol=0, atol=atol_s)
    np.testing.assert_allclose(there.positions_m[:, :2], walk(10.0).positions_m[:, :2], rtol=0, atol=2e-4)
    if wanted == "geopose":
        assert there.rotations is not None and walk(10.0).rotations is not None
        np.testing.assert_allclose(there.rotations, walk(10.0).rotations, atol=1e-7)


def test_positions_alone_come_out_where_no_orientation_is_needed(served: Served, site_id: str) -> None:
    covariances = np.tile(np.diag([0.01, 0.04, 0.09]), (3, 1, 1))
    floors = np.array([0, 1, 1])
    times_s = START_S + np.arange(3.0)
    alone = Trajectory(times_s, np.eye(3), None, covariances, floors, times_s + 0.25)
    text = "".join(csv_text([alone]))
    trajectory_id = imported(served, text, site_id=site_id)["trajectory_id"]
    assert exported(served, trajectory_id, "csv") == text
    features = json.loads(exported(served, trajectory_id, "geojson"))["features"]
    assert [feature["properties"]["floor"] for feature in features] == [0, 1, 1]
    page = served.client.get(f"/trajectories/{trajectory_id}").json()
    assert page["poses"][0]["arrived_at"].endswith(".250000Z") and page["source"]["with_arrivals"]
    again = imported(served, json.dumps({"type": "FeatureCollection", "features": features}), site_id=site_id)
    back = served.client.get(f"/trajectories/{again['trajectory_id']}").json()
    assert back["poses"][0]["covariance"] == page["poses"][0]["covariance"]
    assert [pose["arrived_at"] for pose in back["poses"]] == [pose["arrived_at"] for pose in page["poses"]]
    assert page["poses"][0]["position_sigma_m"] == pytest.approx([0.1, 0.2, 0.3])
    listed = served.client.get("/trajectories", params={"site_id": site_id, "max_sigma_m": 0.31}).json()
    assert trajectory_id in {item["trajectory_id"] for item in listed["trajectories"]}
    for wanted in ("tum", "kitti", "euroc", "geopose"):
        answer = served.client.get(f"/trajectories/{trajectory_id}", params={"format": wanted})
        assert "positions only" in assert_problem(answer, 409, "conflict")["detail"]


# Bad files

TUM = "{0} 1 2 3 0 0 0 1\n"


@pytest.mark.parametrize(
    ("content", "line", "said"),
    [
        (TUM.format(1) + TUM.format(1), 2, "comes twice"),
        (TUM.format(2) + TUM.format(1), 2, "before the one above"),
        (TUM.format(1) + "2 1 nan 3 0 0 0 1\n", 2, "finite"),
        (TUM.format(1) + "2 1 2 3 0 0 0\n", 2, "7 columns"),
        (TUM.format(1) + "2 1 2 3 0 0 0 0\n", 2, "length 0"),
        (TUM.format(1_760_000_000) + TUM.format(1_760_000_001_000), 2, "another unit"),
        ("time_s,x_m,y_m\n1,2,three\n", 2, "no number"),
        ("\n\n", None, "empty"),
        (b"\xff\xfe1 2", 1, "UTF-8"),
        ("-5 1 2 3 0 0 0 1\n", None, "before 1970"),
        ('{"type": "FeatureCollection", "features": [{"properties": {}}]}', None, "needs its time"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n", 1, "no known format"),
    ],
)
def test_a_bad_file_is_told_by_line_and_nothing_is_kept(
    served: Served, site_id: str, content: str | bytes, line: int | None, said: str
) -> None:
    before = kept(served)
    answer = served.client.post("/trajectories/import", params={"site_id": site_id}, content=content)
    problem = assert_problem(answer, 422, "unreadable-trajectory")
    assert said in problem["detail"]
    assert problem.get("line") == line
    assert kept(served) == before


def kept(served: Served) -> tuple[int, int]:
    with served.services.database.reading() as session:
        return session.query(TrajectoryRow).count(), session.query(ImportedPosesRow).count()


def leftovers(served: Served) -> list[Path]:
    return list(served.settings.data_dir.glob("trajectory-*"))


@pytest.mark.parametrize(
    ("send", "status", "kind"),
    [
        (lambda client, _site: client.post("/trajectories/import", content="1"), 422, "invalid-input"),
        (lambda client, _site: client.post("/trajectories/import?site_id=nowhere", content="1"), 404, "not-found"),
        (
            lambda client, site: client.post("/trajectories/import", data={"site_id": site}, files={"other": "1"}),
            422,
            "invalid-input",
        ),
        (
            lambda client, site: client.post(f"/trajectories/import?site_id={site}&format=kitti", content="1 2"),
            422,
            "invalid-input",
        ),
        (
            lambda client, site: client.post(f"/trajectories/import?site_id={site}&format=bvh", content="1 2"),
            422,
            "invalid-input",
        ),
    ],
)
def test_a_wrong_request_says_what_is_wrong(
    served: Served, site_id: str, send: Callable[[httpx.Client, str], httpx.Response], status: int, kind: str
) -> None:
    assert_problem(send(served.client, site_id), status, kind)
    assert leftovers(served) == []


def test_latitudes_need_an_anchor(served: Served, tum_id: str) -> None:
    query = {"site_id": served.new_site()}
    answer = served.client.post("/trajectories/import", params=query, content=exported(served, tum_id, "geojson"))
    assert "geo-anchor" in assert_problem(answer, 409, "conflict")["detail"]
