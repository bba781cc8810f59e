"""Measured check bars in, targets of that size out, over HTTP."""

from __future__ import annotations

import pytest

from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem, room_control_points, room_photos

BATCH = {"name": "floor 1", "codes": "389", "bar_across_mm": 99.0, "bar_along_mm": 98.5, "sigma_mm": 0.2}


def test_batches_are_put_shown_and_replaced(served: Served) -> None:
    url = f"/sites/{served.new_site()}/print-batches"
    assert served.client.get(url).json()["print_batches"] == []
    answer = served.client.put(url, json={"print_batches": [BATCH]})
    assert answer.status_code == 200, answer.text
    assert answer.json()["print_batches"] == [{**BATCH, "codes": [389]}]
    shown = served.client.get(url).json()
    assert shown == answer.json()
    again = served.client.put(url, json={"print_batches": shown["print_batches"]})
    assert again.json() == shown
    assert served.client.put(url, json={"print_batches": []}).json()["print_batches"] == []
    assert_problem(served.client.get("/sites/nowhere/print-batches"), 404, "not-found")


@pytest.mark.parametrize(
    "faulty",
    [{"codes": "390"}, {"codes": "x"}, {"codes": []}, {"bar_across_mm": 9.9}, {"sigma_mm": 0}, {"name": ""}, {"u": 1}],
)
def test_a_batch_that_cannot_be_is_refused_and_changes_nothing(served: Served, faulty: dict[str, object]) -> None:
    url = f"/sites/{served.new_site()}/print-batches"
    assert served.client.put(url, json={"print_batches": [BATCH]}).is_success
    assert_problem(served.client.put(url, json={"print_batches": [{**BATCH, **faulty}]}), 422, "invalid-input")
    assert len(served.client.get(url).json()["print_batches"]) == 1


def test_a_build_uses_them_and_doubts_what_the_photographs_contradict(served: Served, room: SurveyedRoom) -> None:
    """The demonstration room is printed at its nominal size: bars measured at 98 % are doubted."""
    published = served.client.get(f"/sites/{room.site_id}/targets").json()["targets"]
    codes = [target["code"] for target in published[:6]]
    site_id = served.new_site()
    assert served.put_control_points(site_id, room_control_points()).is_success
    batch = {"name": "mixed up", "codes": codes, "bar_across_mm": 98.0, "bar_along_mm": 98.0, "sigma_mm": 0.1}
    assert served.client.put(f"/sites/{site_id}/print-batches", json={"print_batches": [batch]}).is_success
    survey_id = served.new_survey(site_id, device_id="surveyor")
    for name, data in room_photos("survey").items():
        assert served.put_photo(survey_id, name, data).is_success
    job = served.build(survey_id)
    assert job["state"] == "succeeded", job
    report = served.client.get(f"/sites/{site_id}/report", params={"format": "json"}).json()
    named = {record["name"]: record for record in report["print_batches"] if not record["found"]}
    assert set(named) == {"", "mixed up"}
    assert named["mixed up"]["measured"] == [0.98, 0.98]
    assert any("mixed up" in warning and "measure them again" in warning for warning in report["warnings"])
    page = served.client.get(f"/sites/{site_id}/report", params={"format": "html"}).text
    assert "Print batch mixed up" in page
