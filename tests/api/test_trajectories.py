"""Trajectories over HTTP: a phone walks, an analyst asks, a page watches."""

from __future__ import annotations

import csv
import io
import json
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image

from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem
from tests.storage.walks import START_S, Step, add_steps

NOON = "2026-05-01T12:00:00Z"
NOON_S = 1777636800.0
HERE = (1.0, 2.0, 1.5)
ANCHOR = {"latitude_deg": 48.15, "longitude_deg": 11.57, "height_m": 515.0}


@dataclass(frozen=True)
class Walk:
    """A trajectory with four snapshots: pose, failure, pose, pose."""

    site_id: str
    trajectory_id: str

    @property
    def path(self) -> str:
        return f"/trajectories/{self.trajectory_id}"


STEPS = (Step(1.0, HERE), Step(2.0), Step(3.0, (3.0, 2.0, 1.5)), Step(4.0, (4.0, 2.0, 1.5), sigma_m=0.01))


def opened(served: Served, site_id: str, **body: Any) -> dict[str, Any]:
    answer = served.client.post("/trajectories", json={"site_id": site_id, **body})
    assert answer.status_code == 201, answer.text
    trajectory: dict[str, Any] = answer.json()
    return trajectory


@pytest.fixture(scope="module")
def walk(served: Served) -> Walk:
    site_id = served.new_site()
    trajectory_id = opened(served, site_id, device_id="walker")["trajectory_id"]
    add_steps(served.services.database, trajectory_id, site_id, STEPS)
    return Walk(site_id, trajectory_id)


def black() -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", (320, 240)).save(buffer, "PNG")
    return buffer.getvalue()


# A phone


def test_a_phone_fills_a_trajectory_and_closes_it(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    trajectory = opened(served, room.site_id, device_id="surveyor", name="first walk")
    trajectory_id = trajectory["trajectory_id"]
    assert (trajectory["pose_count"], trajectory["closed_at"], trajectory["first_at"]) == (0, None, None)
    pose = served.locate(room.site_id, snapshot, trajectory_id=trajectory_id, captured_at=NOON, device_id="surveyor")
    assert pose.status_code == 200, pose.text
    failed = served.locate(room.site_id, black(), trajectory_id=trajectory_id, captured_at=str(NOON_S - 60))
    assert assert_problem(failed, 422, "not-located")["trajectory_id"] == trajectory_id
    page = served.client.get(f"/trajectories/{trajectory_id}").json()
    assert (page["name"], page["pose_count"], page["failures_by_reason"]) == ("first walk", 1, {"no-targets": 1})
    assert (page["first_at"], page["last_at"]) == ("2026-05-01T11:59:00.000000Z", "2026-05-01T12:00:00.000000Z")
    (kept,), (failure,) = page["poses"], page["failures"]
    for name in ("pose_id", "captured_at", "map_version", "device_id", "time_source"):
        assert kept[name] == pose.json()[name]
    for name in ("position_m", "orientation_xyzw", "covariance", "position_sigma_m"):
        np.testing.assert_allclose(kept[name], pose.json()[name], rtol=1e-12, atol=1e-15)
    assert (failure["pose_id"], failure["reason"], failure["ordinal"]) == (failed.json()["pose_id"], "no-targets", 2)
    assert failure["detail"] == failed.json()["detail"]
    closed = served.client.post(f"/trajectories/{trajectory_id}/close").json()
    assert closed["closed_at"] is not None
    assert served.client.post(f"/trajectories/{trajectory_id}/close").json() == closed
    assert_problem(served.locate(room.site_id, snapshot, trajectory_id=trajectory_id), 409, "conflict")


def test_a_phone_without_a_connection_chooses_the_id(served: Served) -> None:
    mine, theirs = served.new_site(), served.new_site()
    chosen = "01a00000-0000-7000-8000-0000000000aa"
    first = opened(served, mine, trajectory_id=chosen, device_id="phone", name="walk")
    assert first["trajectory_id"] == chosen
    assert opened(served, mine, trajectory_id=chosen, device_id="phone", name="walk") == first
    elsewhere = served.client.post("/trajectories", json={"site_id": theirs, "trajectory_id": chosen})
    assert_problem(elsewhere, 409, "conflict")
    by_chance = "01a00000-0000-4000-8000-0000000000aa"  # version 4: it says no time
    refused = served.client.post("/trajectories", json={"site_id": mine, "trajectory_id": by_chance})
    assert_problem(refused, 422, "invalid-input")


def test_what_cannot_be_opened(served: Served) -> None:
    assert_problem(served.client.post("/trajectories", json={"site_id": "nowhere"}), 404, "not-found")
    assert_problem(served.client.post("/trajectories", json={}), 422, "invalid-input")
    assert_problem(served.client.post("/trajectories", json={"site_id": "a", "colour": "red"}), 422, "invalid-input")
    for call in (served.client.post("/trajectories/nowhere/close"), served.client.get("/trajectories/nowhere")):
        assert_problem(call, 404, "not-found")


# An analyst


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({}, True),
        ({"device_id": "walker"}, True),
        ({"device_id": "sitter"}, False),
        ({"from": START_S + 4.0, "to": START_S + 9.0}, True),
        ({"from": START_S + 4.5}, False),
        ({"to": "2026-01-01T00:00:00Z"}, False),
        ({"bbox": "2.5,1.5,3.5,2.5"}, True),
        ({"bbox": "2.5,1.5,0,3.5,2.5,1"}, False),
        ({"bbox": "3.5,1.5,4.5,2.5", "max_sigma_m": 0.005}, False),
        ({"bbox": "3.5,1.5,4.5,2.5", "max_sigma_m": 0.02}, True),
    ],
)
def test_trajectories_are_found(served: Served, walk: Walk, asked: dict[str, Any], found: bool) -> None:
    answer = served.client.get("/trajectories", params={"site_id": walk.site_id, **asked})
    assert answer.status_code == 200, answer.text
    assert [item["trajectory_id"] for item in answer.json()["trajectories"]] == [walk.trajectory_id] * found


def test_pages_hold_poses_and_failures_in_order(served: Served, walk: Walk) -> None:
    ordinals: list[int] = []
    cursor: str | None = ""
    while cursor is not None:
        page = served.client.get(walk.path, params={"limit": 3, **({"cursor": cursor} if cursor else {})}).json()
        ordinals += sorted(item["ordinal"] for item in page["poses"] + page["failures"])
        cursor = page["next_cursor"]
    assert ordinals == [1, 2, 3, 4]


def test_a_range_is_half_open(served: Served, walk: Walk) -> None:
    page = served.client.get(walk.path, params={"from": START_S + 1.0, "to": START_S + 3.0}).json()
    assert [item["ordinal"] for item in page["poses"] + page["failures"]] == [1, 2]


def test_csv_and_tum_hold_the_poses(served: Served, walk: Walk) -> None:
    answer = served.client.get(walk.path, params={"format": "csv", "from": START_S + 2.0})
    assert answer.headers["content-type"].startswith("text/csv")
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    assert [float(row["x_m"]) for row in rows] == [3.0, 4.0]
    answer = served.client.get(walk.path, params={"format": "tum"})
    assert answer.headers["content-type"].startswith("text/plain")
    lines = np.loadtxt(io.StringIO(answer.text))
    np.testing.assert_allclose(lines[:, 0], [START_S + 1.0, START_S + 3.0, START_S + 4.0])


def test_geojson_needs_the_earth(served: Served, walk: Walk) -> None:
    assert "geo_anchor" in assert_problem(served.client.get(f"{walk.path}?format=geojson"), 409, "conflict")["detail"]
    assert served.client.patch(f"/sites/{walk.site_id}", json={"geo_anchor": ANCHOR}).status_code == 200
    answer = served.client.get(f"{walk.path}?format=geojson")
    assert answer.headers["content-type"] == "application/geo+json"
    features = answer.json()["features"]
    assert [feature["properties"]["position_m"][0] for feature in features] == [1.0, 3.0, 4.0]
    assert abs(features[0]["geometry"]["coordinates"][1] - 48.15) < 1e-4


@pytest.mark.parametrize("name", ["kitti", "kitti-times", "euroc"])
def test_formats_of_robotics_have_a_line_per_pose(served: Served, walk: Walk, name: str) -> None:
    text = served.client.get(walk.path, params={"format": name}).text
    assert len([line for line in text.splitlines() if not line.startswith("#")]) == 3


@pytest.mark.parametrize(
    "asked",
    [
        {"from": "yesterday"},
        {"from": "2", "to": "1"},
        {"bbox": "1,2,3"},
        {"bbox": "a,b,c,d"},
        {"bbox": "5,5,1,1"},
        {"max_sigma_m": "0"},
        {"max_sigma_m": "nan"},
        {"cursor": "x"},
    ],
)
def test_what_is_not_understood_is_refused(served: Served, walk: Walk, asked: dict[str, str]) -> None:
    answer = served.client.get("/trajectories", params={"site_id": walk.site_id, **asked})
    assert_problem(answer, 422, "invalid-input")


def test_a_box_needs_its_site(served: Served) -> None:
    answer = served.client.get("/trajectories", params={"bbox": "0,0,1,1"})
    assert "site_id" in assert_problem(answer, 422, "invalid-input")["detail"]


# A page that watches


def events(response: httpx.Response) -> Iterator[dict[str, Any]]:
    """Server-sent events as they come."""
    fields: dict[str, str] = {}
    for line in response.iter_lines():
        if line.startswith(":"):
            continue
        if line:
            name, _, value = line.partition(": ")
            fields[name] = value
        elif fields:
            yield {**fields, "data": json.loads(fields["data"])}
            fields = {}


def test_events_resume_after_the_last_that_came(served: Served, walk: Walk) -> None:
    trajectory_id = opened(served, walk.site_id)["trajectory_id"]
    add_steps(served.services.database, trajectory_id, walk.site_id, STEPS)
    served.client.post(f"/trajectories/{trajectory_id}/close")
    path = f"/trajectories/{trajectory_id}/events"
    for options in ({"headers": {"Last-Event-ID": "1"}}, {"params": {"last_event_id": "1"}}):
        with served.client.stream("GET", path, **options) as response:
            assert response.headers["content-type"].startswith("text/event-stream")
            found = list(events(response))
        assert [(item["event"], item.get("id")) for item in found] == [
            ("failure", "2"),
            ("pose", "3"),
            ("pose", "4"),
            ("closed", None),
        ]
        assert found[0]["data"]["reason"] == "no-targets"
        assert found[1]["data"]["position_m"] == [3.0, 2.0, 1.5]
        assert found[3]["data"]["pose_count"] == 3
    assert_problem(served.client.get(path, headers={"Last-Event-ID": "5"}), 422, "invalid-input")
    assert_problem(served.client.get("/trajectories/nowhere/events"), 404, "not-found")


def test_a_snapshot_appears_while_the_page_watches(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    trajectory_id = opened(served, room.site_id)["trajectory_id"]
    served.locate(room.site_id, black(), trajectory_id=trajectory_id)  # before the page is opened
    answers: list[httpx.Response] = []

    def walk() -> None:
        for image in (snapshot, black()):
            answers.append(served.locate(room.site_id, image, trajectory_id=trajectory_id))
        served.client.post(f"/trajectories/{trajectory_id}/close")

    walker = threading.Thread(target=walk)
    with served.client.stream("GET", f"/trajectories/{trajectory_id}/events") as response:
        walker.start()  # the stream has begun: what comes from now on is in it
        found = list(events(response))
    walker.join()
    assert [(item["event"], item.get("id")) for item in found] == [("pose", "2"), ("failure", "3"), ("closed", None)]
    assert [item["data"]["pose_id"] for item in found[:2]] == [answer.json()["pose_id"] for answer in answers]
