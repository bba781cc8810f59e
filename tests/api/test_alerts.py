"""A target is moved after the survey: the snapshots of a phone tell it, over HTTP, from pixels."""

from __future__ import annotations

import numpy as np
import pytest

from tests.api.bumped_room import MOVED, SHIFT_M, UNKNOWN, VIEWS_M, Watched, alerts, bumped_room, publish
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem
from tests.demo_room import demo_scene, photograph

GROSS_SIGMAS = 5.0
MAP_MM = 2.0  # what the demonstration room's map may err by at one target


@pytest.fixture(scope="module")
def watched(served: Served, room: SurveyedRoom) -> Watched:
    return bumped_room(served, room.site_id)


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
