"""Dots marked by hand over HTTP: stored, checked, and taken by the next build."""

from __future__ import annotations

from typing import Any

import pytest

from tests.api.serving import Served, assert_problem, room_control_points, room_photos

PHOTOS = room_photos("survey")
NAME = next(iter(PHOTOS))


@pytest.fixture(scope="module")
def survey_id(served: Served) -> str:
    site_id = served.new_site(name="marked")
    served.put_control_points(site_id, room_control_points())
    found = served.new_survey(site_id)
    for name, data in PHOTOS.items():
        assert served.put_photo(found, name, data).status_code == 201
    return found


def mark(code: int = 16925, dot: str = "A", x_px: float = 10.0, y_px: float = 20.0, **more: Any) -> dict[str, Any]:
    return {"code": code, "dot": dot, "x_px": x_px, "y_px": y_px, **more}


def test_marks_are_replaced_and_removed(served: Served, survey_id: str) -> None:
    path = f"/surveys/{survey_id}/images/{NAME}/marks"
    assert served.client.get(path).json() == {"marks": []}
    put = served.client.put(path, json={"marks": [mark(dot="r2c1", sigma_px=0.25), mark()]})
    assert put.status_code == 200, put.text
    expected = [mark(sigma_px=0.5), mark(dot="r2c1", sigma_px=0.25)]
    assert put.json() == served.client.get(path).json() == {"marks": expected}
    other = list(PHOTOS)[1]
    assert served.client.get(f"/surveys/{survey_id}/images/{other}/marks").json() == {"marks": []}
    assert served.client.delete(path).status_code == 204
    assert served.client.get(path).json() == {"marks": []}


@pytest.mark.parametrize(
    ("wrong", "field"),
    [
        ([mark(code=16926)], "marks.0.code"),
        ([mark(), mark(x_px=11.0)], "marks.1.dot"),
        ([mark(x_px=1280.0)], "marks.0.x_px"),
        ([mark(y_px=-0.7)], "marks.0.y_px"),
    ],
)
def test_marks_that_cannot_be_right_are_refused(
    served: Served, survey_id: str, wrong: list[dict[str, Any]], field: str
) -> None:
    path = f"/surveys/{survey_id}/images/{NAME}/marks"
    assert assert_problem(served.client.put(path, json={"marks": wrong}), 422, "invalid-input")["field"] == field
    assert served.client.get(path).json() == {"marks": []}
    assert_problem(served.client.put(path, json={"marks": [mark(dot="centre")]}), 422, "invalid-input")
    assert_problem(served.client.put(path.replace(NAME, "no.jpg"), json={"marks": []}), 404, "not-found")


def test_a_build_takes_marks_and_tells_those_it_cannot(served: Served, survey_id: str) -> None:
    """Targets that too few photographs show are marked in one more, where the map says that their dots are."""
    first = served.build(survey_id)
    assert first["state"] == "succeeded", first
    site_id = first["site_id"]
    targets = {target["code"]: target for target in served.client.get(f"/sites/{site_id}/targets").json()["targets"]}
    seen = served.client.get(f"/surveys/{survey_id}/images/{NAME}/detection").json()["targets"]
    code = next(target["code"] for target in seen if target["code"] in targets)
    rays = targets[code]["rays"]
    (dots_px,) = [target["dots_px"] for target in seen if target["code"] == code]
    hidden = next(other for other in targets if other not in {target["code"] for target in seen})
    # One mark moves a dot by far: the adjustment notices, and says nothing of the three that make no target.
    wild = mark(code=code, x_px=dots_px[0][0] + 30.0, y_px=dots_px[0][1], sigma_px=0.1)
    few = [mark(code=hidden, dot=dot, x_px=100.0 + index) for index, dot in enumerate("ABC")]
    path = f"/surveys/{survey_id}/images/{NAME}/marks"
    assert served.client.put(path, json={"marks": [wild, *few]}).status_code == 200
    second = served.build(survey_id)
    assert second["state"] == "succeeded", second
    report = served.client.get(f"/sites/{site_id}/report?format=json").json()
    assert any(f"Marks of target {hidden} in {NAME} are not used" in warning for warning in report["warnings"])
    (again,) = [target for target in report["targets"] if target["code"] == code]
    (before,) = [
        target
        for target in served.client.get(f"/sites/{site_id}/report?format=json&version=1").json()["targets"]
        if target["code"] == code
    ]
    assert again["rms_px"] > before["rms_px"] or again["rays"] < rays, "the wild mark took part"
