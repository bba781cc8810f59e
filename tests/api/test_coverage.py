"""Predicted accuracy of a surveyed site over HTTP: JSON, pictures, suggestions, refusals."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest

from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem

COARSE = {"step_m": 1.0, "headings": 4}
OUTLINE = "0,0 5,0 5,4 0,4"


def coverage(served: Served, site_id: str, **query: Any) -> dict[str, Any]:
    answer = served.client.get(f"/sites/{site_id}/coverage", params={**COARSE, **query})
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def test_coverage_of_a_surveyed_room(served: Served, room: SurveyedRoom) -> None:
    found = coverage(served, room.site_id, outline=OUTLINE)
    assert found["camera"]["source"] == "survey"
    assert found["summary"]["positions"] == len(found["positions"]) == 20
    best = [position["best_m"] for position in found["positions"]]
    # Four control points of 1 mm hold the datum to about half of that: no 95 % radius is under 1 mm.
    assert all(radius_m is not None and 0.001 < radius_m < 0.05 for radius_m in best)
    worst = [position["worst_m"] for position in found["positions"]]
    assert all(low <= high for low, high in zip(best, worst, strict=True) if high is not None)


def test_a_worse_camera_is_predicted_worse(served: Served, room: SurveyedRoom) -> None:
    surveyed = coverage(served, room.site_id)["summary"]["best"]["median_m"]
    from_exif = coverage(served, room.site_id, width_px=1280, height_px=720, focal_35mm=26)
    assert from_exif["camera"]["source"] == "exif"
    assert from_exif["summary"]["best"]["median_m"] > 1.5 * surveyed


def test_pictures(served: Served, room: SurveyedRoom) -> None:
    query = {**COARSE, "outline": OUTLINE}
    svg = served.client.get(f"/sites/{room.site_id}/coverage", params={**query, "format": "svg"})
    assert svg.headers["content-type"] == "image/svg+xml"
    texts = [
        element.text or "" for element in ElementTree.fromstring(svg.text).iter("{http://www.w3.org/2000/svg}text")
    ]
    assert "X, m" in texts and any(text.endswith(" mm") for text in texts)
    png = served.client.get(f"/sites/{room.site_id}/coverage", params={**query, "format": "png"})
    picture = cv2.imdecode(np.frombuffer(png.content, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None and picture.shape[1] == 1040


def test_suggestions_hang_on_the_walls(served: Served, room: SurveyedRoom) -> None:
    found = coverage(served, room.site_id, outline=OUTLINE, suggest=2)
    assert len(found["suggestions"]) == 2
    for suggestion in found["suggestions"]:
        x_m, y_m, z_m = suggestion["position_m"]
        assert min(abs(x_m), abs(x_m - 5), abs(y_m), abs(y_m - 4)) == pytest.approx(0.001, abs=1e-6)
        assert 0 < z_m < 3
        before, after = suggestion["before"], suggestion["after"]
        assert after["lacking"] <= before["lacking"]


@pytest.mark.parametrize(
    ("query", "field"),
    [
        ({"suggest": 1}, "suggest"),
        ({"outline": "0,0 1,0 2,0"}, "outline"),
        ({"walls": "1,1 1,1"}, "walls"),
        ({"area": "5,0 0,4"}, "area"),
        ({"width_px": 640}, "width_px"),
    ],
)
def test_contradictions_are_named(served: Served, room: SurveyedRoom, query: dict[str, Any], field: str) -> None:
    answer = served.client.get(f"/sites/{room.site_id}/coverage", params=query)
    assert assert_problem(answer, 422, "invalid-input")["field"] == field


def test_too_fine_a_grid_is_refused(served: Served, room: SurveyedRoom) -> None:
    answer = served.client.get(f"/sites/{room.site_id}/coverage", params={"area": "0,0 1000,1000", "step_m": 0.1})
    assert "larger step" in assert_problem(answer, 422, "invalid-input")["detail"]


def test_no_map_no_coverage(served: Served) -> None:
    site_id = served.new_site(name="bare")
    assert_problem(served.client.get(f"/sites/{site_id}/coverage"), 409, "conflict")
    assert_problem(served.client.get("/sites/none/coverage"), 404, "not-found")
