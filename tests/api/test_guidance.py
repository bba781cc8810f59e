"""A survey is photographed step by step and says what it lacks, over HTTP with the real detector."""

from __future__ import annotations

import time
from typing import Any

from sqlalchemy import func, select

from app.storage.models import DetectionRow
from tests.api.serving import BUILD_S, Served, assert_problem, room_control_points, room_photos

PHOTOS = room_photos("survey")


def guidance(served: Served, survey_id: str) -> dict[str, Any]:
    """What the survey lacks once all photographs were looked at."""
    deadline_s = time.monotonic() + BUILD_S
    while time.monotonic() < deadline_s:
        answer = served.client.get(f"/surveys/{survey_id}/guidance")
        assert answer.status_code == 200, answer.text
        found: dict[str, Any] = answer.json()
        if found["pending"] == 0:
            return found
        time.sleep(0.05)
    raise AssertionError(f"photographs were not looked at: {found}")


def detections(served: Served) -> int:
    with served.services.database.reading() as session:
        return session.scalar(select(func.count()).select_from(DetectionRow)) or 0


def test_guidance_follows_the_photographs(served: Served) -> None:
    site_id = served.new_site(name="guided")
    survey_id = served.new_survey(site_id)
    empty = guidance(served, survey_id)
    assert (empty["photographs"], empty["targets"], empty["frame"]) == (0, [], "none")
    names = list(PHOTOS)
    for name in names[:2]:
        served.put_photo(survey_id, name, PHOTOS[name])
    early = guidance(served, survey_id)
    assert (early["photographs"], early["oriented"]) == (2, 2)
    assert all(target["state"] != "good" and target["advice"] for target in early["targets"])
    assert early["frame"] == "model"
    assert "taken, facing the target" in early["next_shot"]["shot"]["text"]

    served.put_control_points(site_id, room_control_points())
    for name in names[2:10]:
        served.put_photo(survey_id, name, PHOTOS[name])
    later = guidance(served, survey_id)
    good = [target for target in later["targets"] if target["state"] == "good"]
    assert len(good) > 5
    assert all(target["rays"] >= 3 and target["angle_deg"] >= 5.0 and not target["advice"] for target in good)
    assert later["frame"] == "site"
    x_m, y_m, z_m = later["next_shot"]["shot"]["position_m"]
    assert -0.5 < x_m < 5.5 and -0.5 < y_m < 4.5 and 0.0 < z_m < 2.6, "the next shot is taken in the room"


def test_a_build_takes_what_guidance_detected(served: Served) -> None:
    survey_id = served.new_survey(served.new_site(name="detected once"))
    for name, data in list(PHOTOS.items())[:6]:
        served.put_photo(survey_id, name, data)
    guidance(served, survey_id)
    before = detections(served)
    assert served.build(survey_id)["state"] == "succeeded"
    assert detections(served) == before


def test_a_photograph_that_cannot_be_read_is_named(served: Served) -> None:
    survey_id = served.new_survey(served.new_site(name="torn"))
    name, data = next(iter(PHOTOS.items()))
    assert served.put_photo(survey_id, name, data[: len(data) // 3]).status_code == 201
    assert guidance(served, survey_id)["unusable"] == [name]


def test_a_survey_that_is_not_there(served: Served) -> None:
    assert_problem(served.client.get("/surveys/none/guidance"), 404, "not-found")
