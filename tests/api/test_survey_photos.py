"""One photograph of a survey over HTTP: its bytes, a smaller picture, what was seen in it."""

from __future__ import annotations

import io

import pytest
from PIL import Image

from tests.api.serving import Served, assert_problem, room_photos

NAME, DATA = next(iter(room_photos("survey").items()))


@pytest.fixture(scope="module")
def survey_id(served: Served) -> str:
    found = served.new_survey(served.new_site(name="photographs"))
    assert served.put_photo(found, NAME, DATA).status_code == 201
    return found


def test_a_photograph_comes_back_as_it_was_sent(served: Served, survey_id: str) -> None:
    answer = served.client.get(f"/surveys/{survey_id}/images/{NAME}")
    assert answer.status_code == 200
    assert (answer.content, answer.headers["content-type"]) == (DATA, "image/jpeg")


def test_a_smaller_picture_is_sent_once(served: Served, survey_id: str) -> None:
    path = f"/surveys/{survey_id}/images/{NAME}"
    answer = served.client.get(path, params={"width_px": 200})
    assert Image.open(io.BytesIO(answer.content)).width == 200
    tag = answer.headers["etag"]
    again = served.client.get(path, params={"width_px": 200}, headers={"If-None-Match": f'"other", W/{tag}'})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
    wider = served.client.get(path, params={"width_px": 201}, headers={"If-None-Match": tag})
    assert wider.status_code == 200
    assert_problem(served.client.get(path, params={"width_px": 4}), 422, "invalid-input")


def test_a_photograph_that_is_not_there_says_so(served: Served, survey_id: str) -> None:
    for path in ("", "/detection"):
        problem = assert_problem(served.client.get(f"/surveys/{survey_id}/images/no.jpg{path}"), 404, "not-found")
        assert problem["filename"] == "no.jpg"
    assert_problem(served.client.get(f"/surveys/none/images/{NAME}"), 404, "not-found")
    assert_problem(served.client.get(f"/surveys/{survey_id}/images/a%00b.jpg"), 404, "not-found")


def test_a_photograph_is_looked_at_when_somebody_asks(served: Served, survey_id: str) -> None:
    answer = served.client.get(f"/surveys/{survey_id}/images/{NAME}/detection")
    assert answer.status_code == 200, answer.text
    seen = answer.json()
    assert (seen["width_px"], seen["height_px"], seen["quarter_turns"]) == (1280, 720, 0)
    assert len(seen["targets"]) > 10
    for target in seen["targets"]:
        assert (len(target["dots_px"]), len(target["measured"]), len(target["sigma_px"])) == (16, 16, 16)
        assert all(0 < sigma_px < 5 for sigma_px in target["sigma_px"])
    assert all(refused["reason"] and refused["text"] for refused in seen["rejected"])
    assert served.client.get(f"/surveys/{survey_id}/images/{NAME}/detection").json() == seen
    eager = served.client.get(f"/surveys/{survey_id}/images/{NAME}/detection", params={"strictness": "eager"})
    assert len(eager.json()["targets"]) >= len(seen["targets"]) - 1
