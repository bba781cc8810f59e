"""A target is moved after the survey: the snapshots of a phone tell it, over HTTP, from pixels."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import httpx
import numpy as np
import pytest

from app.geometry.target_map import TargetMap
from app.storage.ids import new_id
from app.storage.records import Origin, Publication
from app.storage.target_maps import TargetMapRepository
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem
from tests.demo_room import demo_camera, demo_scene, photograph, with_moved

MOVED, SHIFT_M = 72185, np.array([0.012, 0.0, -0.009])
UNKNOWN = 66957  # hangs in the room and is not in the map
# Eye and aim of the snapshots, all before the north wall, where both targets hang.
VIEWS_M = [
    ([0.8, 1.3, 1.4], [1.0, 4.0, 1.6]),
    ([1.6, 1.5, 1.5], [1.0, 4.0, 1.6]),
    ([2.4, 1.9, 1.5], [1.1, 4.0, 1.6]),
    ([1.2, 2.2, 1.6], [1.1, 4.0, 1.6]),
    ([2.0, 1.1, 1.3], [1.2, 4.0, 1.6]),
    ([0.6, 1.9, 1.5], [1.1, 4.0, 1.6]),
]
GROSS_SIGMAS = 5.0
MAP_MM = 2.0  # what the demonstration room's map may err by at one target


@dataclass(frozen=True)
class Watched:
    """A site with a map that its room does not fit any more, and its alerts before and after the snapshots."""

    site_id: str
    target_map: TargetMap
    early: list[dict[str, object]]
    answers: list[httpx.Response]


def publish(served: Served, site_id: str, target_map: TargetMap) -> None:
    origin = Origin(served.new_survey(site_id), new_id())
    with served.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, Publication(target_map, origin, (), (), {})))


def alerts(served: Served, site_id: str, **query: str | int) -> list[dict[str, object]]:
    answer = served.client.get(f"/sites/{site_id}/alerts", params=query)
    assert answer.status_code == 200, answer.text
    found: list[dict[str, object]] = answer.json()["alerts"]
    return found


@pytest.fixture(scope="module")
def watched(served: Served, room: SurveyedRoom) -> Watched:
    site_id = served.new_site(name="the room after somebody bumped into it")
    with served.services.database.reading() as session:
        whole = TargetMapRepository(session).load(room.site_id, 1)
    target_map = replace(whole, targets=tuple(target for target in whole.targets if target.code != UNKNOWN))
    publish(served, site_id, target_map)
    camera = demo_camera()
    fx, fy, cx, cy, *dist = camera.intrinsics.tolist()
    told = {"width_px": camera.width_px, "height_px": camera.height_px, "fx": fx, "fy": fy, "cx": cx, "cy": cy}
    scene, answers = with_moved(demo_scene(), MOVED, SHIFT_M), []
    early: list[dict[str, object]] = []
    for index, (eye_m, aim_m) in enumerate(VIEWS_M):
        image = photograph(scene, eye_m, aim_m, seed=index)
        sent = {
            "device_id": "phone",
            "camera": json.dumps({**told, "dist": dist}),
            "captured_at": str(1_800_000_000 + index),
        }
        answers.append(served.locate(site_id, image, **sent))
        if index == 1:
            early = alerts(served, site_id)
    return Watched(site_id, target_map, early, answers)


def test_two_snapshots_raise_nothing(watched: Watched) -> None:
    assert watched.early == []


def test_snapshots_are_located_in_spite_of_it(watched: Watched) -> None:
    for answer, (eye_m, _) in zip(watched.answers, VIEWS_M, strict=True):
        assert answer.status_code == 200, answer.text
        assert np.linalg.norm(np.array(answer.json()["position_m"]) - eye_m) < 0.03
        (moved,) = [target for target in answer.json()["targets"] if target["code"] == MOVED]
        assert (moved["used"], moved["reason"]) == (False, "moved-or-misread")


def test_the_moved_target_is_named_with_its_displacement(served: Served, watched: Watched) -> None:
    (alert,) = alerts(served, watched.site_id, kind="moved-target")
    assert (alert["code"], alert["state"], alert["severity"], alert["map_version"]) == (MOVED, "open", "critical", 1)
    displacement = alert["displacement"]
    assert isinstance(displacement, dict)
    error_mm = np.array(displacement["vector_mm"]) - 1e3 * SHIFT_M
    covariance_mm2 = np.array(displacement["covariance_mm2"]) + MAP_MM**2 / GROSS_SIGMAS**2 * np.eye(3)
    assert np.sqrt(error_mm @ np.linalg.solve(covariance_mm2, error_mm)) < GROSS_SIGMAS
    assert displacement["sigma_mm"] < MAP_MM
    assert alert["since"] == "2027-01-15T08:00:00.000000Z"
    assert alert["snapshots"] == alert["places"] == len(VIEWS_M)
    assert f"Target {MOVED} stands" in str(alert["detail"])
    assert "base_version" in str(alert["advice"])


def test_the_target_that_the_map_does_not_hold_is_named(served: Served, watched: Watched) -> None:
    (alert,) = alerts(served, watched.site_id, kind="unknown-target")
    assert (alert["code"], alert["severity"], alert["displacement"]) == (UNKNOWN, "notice", None)


def test_an_alert_tells_the_snapshots_that_it_rests_on(served: Served, watched: Watched) -> None:
    (alert,) = alerts(served, watched.site_id, kind="moved-target")
    sightings = served.client.get(f"/alerts/{alert['alert_id']}/sightings").json()["sightings"]
    assert [sighting["pose_id"] for sighting in sightings] == [
        answer.json()["pose_id"] for answer in reversed(watched.answers)
    ]
    for sighting, (eye_m, _) in zip(sightings, reversed(VIEWS_M), strict=True):
        assert np.linalg.norm(np.array(sighting["camera_m"]) - eye_m) < 0.03
        assert not sighting["used"]
    error_mm = np.median([sighting["movement_mm"] for sighting in sightings], axis=0) - 1e3 * SHIFT_M
    assert np.linalg.norm(error_mm) < GROSS_SIGMAS * MAP_MM
    (unknown,) = alerts(served, watched.site_id, kind="unknown-target")
    seen = served.client.get(f"/alerts/{unknown['alert_id']}/sightings").json()["sightings"]
    assert len(seen) == unknown["snapshots"] and {sighting["movement_mm"] for sighting in seen} == {None}


def test_nothing_else_is_named(served: Served, watched: Watched) -> None:
    assert {alert["code"] for alert in alerts(served, watched.site_id)} == {MOVED, UNKNOWN}


def test_alerts_come_in_pages(served: Served, watched: Watched) -> None:
    url = f"/sites/{watched.site_id}/alerts"
    first = served.client.get(url, params={"limit": 1}).json()
    assert first["watched"] == {"map_version": 1, "snapshots": len(VIEWS_M)}
    second = served.client.get(url, params={"limit": 1, "cursor": first["next_cursor"]}).json()
    assert second["next_cursor"] is None
    both = [alert["alert_id"] for page in (first, second) for alert in page["alerts"]]
    assert both == [alert["alert_id"] for alert in alerts(served, watched.site_id)]


def test_an_alert_is_acknowledged_and_over_with_the_next_map(served: Served, watched: Watched) -> None:
    (alert,) = alerts(served, watched.site_id, kind="moved-target")
    url = f"/alerts/{alert['alert_id']}"
    known = served.client.post(f"{url}/acknowledge", json={"note": "the door hit it"}).json()
    assert (known["state"], known["note"]) == ("acknowledged", "the door hit it")
    assert served.client.get(url).json() == known
    assert alerts(served, watched.site_id, state="open", kind="moved-target") == []
    publish(served, watched.site_id, watched.target_map)
    served.locate(watched.site_id, photograph(demo_scene(), *VIEWS_M[0], seed=9))
    assert {item["state"] for item in alerts(served, watched.site_id)} == {"resolved"}
    assert served.client.get(url).json()["resolved_at"] is not None


def test_a_site_that_is_not_there(served: Served) -> None:
    assert_problem(served.client.get("/sites/nowhere/alerts"), 404, "not-found")
    assert_problem(served.client.get("/alerts/none"), 404, "not-found")
    assert_problem(served.client.post("/alerts/none/acknowledge"), 404, "not-found")


def test_a_site_without_a_map_has_none(served: Served) -> None:
    answer = served.client.get(f"/sites/{served.new_site()}/alerts").json()
    assert (answer["alerts"], answer["watched"]) == ([], {"map_version": None, "snapshots": 0})
