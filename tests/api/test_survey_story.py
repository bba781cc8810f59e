"""A room's photographs in, a target map out, over HTTP with the real detector and the real adjustment."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest

from app.geometry.map_file import map_from_json
from tests.api.conftest import SurveyedRoom
from tests.api.serving import ROOM, Served, assert_problem, room_photos

RMSE_LIMIT_M = 0.005  # a small room with control of 1 mm: far above what it reaches, far below any blunder


def test_the_build_says_what_it_made(served: Served, room: SurveyedRoom) -> None:
    job = room.job
    photographs = len(room_photos("survey"))
    assert (job["done"], job["total"], job["error"]) == (photographs, photographs, None) or job["stage"] != "detect"
    result = job["result"]
    assert result["map_version"] == 1
    assert result["report_url"] == f"/sites/{room.site_id}/report?version=1"
    assert result["unoriented"] == 0
    assert served.client.get(result["report_url"]).status_code == 200
    assert served.client.get(f"/sites/{room.site_id}").json()["map_version"] == 1


def test_the_map_stands_where_the_room_stands(served: Served, room: SurveyedRoom) -> None:
    published = served.client.get(f"/sites/{room.site_id}/targets").json()
    record = json.loads((ROOM / "targets_truth.json").read_text())
    truth = {target["code"]: np.array(target["dots_m"]) for target in record["targets"]}
    assert published["map_version"] == 1
    codes = {target["code"] for target in published["targets"]}
    assert codes <= set(truth), "a code that hangs nowhere was published"
    assert len(codes) == room.job["result"]["targets"] >= 0.9 * len(truth)
    errors_m = np.concatenate([np.array(target["dots_m"]) - truth[target["code"]] for target in published["targets"]])
    assert np.sqrt((errors_m**2).sum(axis=1).mean()) < RMSE_LIMIT_M
    target_map = map_from_json(published).target_map
    assert set(target_map.by_code) == codes


def test_the_map_comes_in_every_format(served: Served, room: SurveyedRoom) -> None:
    url = f"/sites/{room.site_id}/targets"
    count = room.job["result"]["targets"]
    table = served.client.get(url, params={"format": "csv"})
    assert table.headers["content-type"].startswith("text/csv")
    assert len(list(csv.DictReader(io.StringIO(table.text)))) == count
    assert f"element vertex {16 * count}\n" in served.client.get(url, params={"format": "ply"}).text
    assert_problem(served.client.get(url, params={"format": "geojson"}), 409, "conflict")
    served.client.patch(f"/sites/{room.site_id}", json={"geo_anchor": {"latitude_deg": 48.15, "longitude_deg": 11.57}})
    collection = served.client.get(url, params={"format": "geojson"})
    assert collection.headers["content-type"] == "application/geo+json"
    assert len(collection.json()["features"]) == count
    served.client.patch(f"/sites/{room.site_id}", json={"geo_anchor": None})
    assert_problem(served.client.get(url, params={"format": "xml"}), 422, "invalid-input")
    assert_problem(served.client.get(url, params={"version": 99}), 404, "not-found")


def test_the_surveys_camera_is_listed(served: Served, room: SurveyedRoom) -> None:
    cameras = served.client.get("/cameras", params={"site_id": room.site_id}).json()["cameras"]
    (camera,) = [camera for camera in cameras if camera["map_version"] == 1 and camera["source"] == "survey"]
    assert (camera["width_px"], camera["height_px"]) == (1280, 720)
    assert camera["device_id"] == "surveyor"
    assert len(camera["dist"]) == 5
    assert 0 < camera["sigmas"]["fx"] < 0.01 * camera["fx"]


def test_a_rebuild_without_a_photograph_is_a_version_of_its_own(served: Served, room: SurveyedRoom) -> None:
    job = served.build(room.survey_id, exclude={"images": ["IMG_0003.jpg"]}, activate=False)
    assert job["state"] == "succeeded", job
    version = job["result"]["map_version"]
    maps = {item["map_version"]: item for item in served.client.get(f"/sites/{room.site_id}/maps").json()["maps"]}
    assert maps[1]["active"]
    assert not maps[version]["active"]
    activated = served.client.post(f"/sites/{room.site_id}/maps/{version}/activate").json()
    assert (activated["map_version"], activated["active"]) == (version, True)
    assert served.client.get(f"/sites/{room.site_id}/targets").json()["map_version"] == version
    served.client.post(f"/sites/{room.site_id}/maps/1/activate")
    assert_problem(served.client.post(f"/sites/{room.site_id}/maps/99/activate"), 404, "not-found")


def test_events_tell_the_way_and_the_end(served: Served, room: SurveyedRoom) -> None:
    job_id = served.client.post(f"/surveys/{room.survey_id}/build", json={"activate": False}).json()["job_id"]
    with served.client.stream("GET", f"/jobs/{job_id}/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        events = [json.loads(line.removeprefix("data: ")) for line in stream.iter_lines() if line.startswith("data: ")]
    assert events[-1]["state"] == "succeeded"
    assert [event["state"] for event in events[:-1]] == sorted(event["state"] for event in events[:-1])
    assert events[-1] == served.client.get(f"/jobs/{job_id}").json()
    assert_problem(served.client.get("/jobs/nowhere/events"), 404, "not-found")


def test_a_cancelled_build_publishes_nothing(served: Served, room: SurveyedRoom) -> None:
    before = served.client.get(f"/sites/{room.site_id}/maps").json()
    job_id = served.client.post(f"/surveys/{room.survey_id}/build", json={"strictness": "strict"}).json()["job_id"]
    cancelled = served.client.post(f"/jobs/{job_id}/cancel")
    assert cancelled.json()["state"] == "cancelled"
    assert served.wait(job_id)["state"] == "cancelled"
    assert_problem(served.client.post(f"/jobs/{room.job['job_id']}/cancel"), 409, "conflict")
    follow_up = served.build(room.survey_id, activate=False)
    assert follow_up["state"] == "succeeded", follow_up
    after = served.client.get(f"/sites/{room.site_id}/maps").json()
    assert len(after["maps"]) == len(before["maps"]) + 1


def test_photographs_of_a_map_say_where_they_were_taken(served: Served, room: SurveyedRoom) -> None:
    version = room.job["result"]["map_version"]
    photos = served.client.get(f"/sites/{room.site_id}/maps/{version}/photos").json()["photos"]
    report = served.client.get(f"/sites/{room.site_id}/report", params={"format": "json", "version": version}).json()
    assert {photo["name"]: photo["position_m"] for photo in photos if photo["position_m"]} == {
        photo["name"]: photo["position_m"] for photo in report["photos"]
    }
    targets = served.client.get(f"/sites/{room.site_id}/targets", params={"version": version}).json()["targets"]
    for target in targets:
        assert target["rays"] == sum(target["code"] in (photo["codes"] or []) for photo in photos)
    posed = next(photo for photo in photos if photo["position_m"])
    assert posed["camera"]["width_px"] > posed["camera"]["height_px"] > 0
    assert_problem(served.client.get(f"/sites/{room.site_id}/maps/99/photos"), 404, "not-found")


@pytest.mark.parametrize("call", ["targets", "report"])
def test_a_site_without_a_map_says_so(served: Served, call: str) -> None:
    problem = assert_problem(served.client.get(f"/sites/{served.new_site()}/{call}"), 409, "conflict")
    assert "build" in problem["detail"]


def test_a_build_extends_a_map_whose_targets_stand(served: Served, room: SurveyedRoom) -> None:
    points = served.client.get(f"/sites/{room.site_id}/control-points").json()["control_points"]
    published = served.client.get(f"/sites/{room.site_id}/targets").json()["targets"]
    plain = sorted({target["code"] for target in published} - {point["code"] for point in points})
    part = served.build(room.survey_id, exclude={"codes": plain[::3]}, activate=False)
    assert part["state"] == "succeeded", part
    base_version = part["result"]["map_version"]
    whole = served.build(room.survey_id, base_version=base_version, activate=False)
    assert whole["state"] == "succeeded", whole

    def targets(version: int) -> dict[int, dict[str, object]]:
        published = served.client.get(f"/sites/{room.site_id}/targets", params={"version": version}).json()
        return {target["code"]: target for target in published["targets"]}

    base, extended = targets(base_version), targets(whole["result"]["map_version"])
    assert set(base) < set(extended)
    assert not set(plain[::3]) & set(base)
    report = served.client.get(whole["result"]["report_url"]).json()["extension"]
    assert report["base_version"] == base_version
    assert set(report["added"]) == set(extended) - set(base)
    assert report["moved"] == []
    for code, target in base.items():
        assert extended[code] == target
    record = json.loads((ROOM / "targets_truth.json").read_text())
    truth = {target["code"]: np.array(target["dots_m"]) for target in record["targets"]}
    errors_m = [np.array(extended[code]["dots_m"]) - truth[code] for code in report["added"]]
    assert np.sqrt((np.concatenate(errors_m) ** 2).sum(axis=1).mean()) < 2 * RMSE_LIMIT_M
