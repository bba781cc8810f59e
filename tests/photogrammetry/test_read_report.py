"""A report survives its JSON."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from app.photogrammetry.read_report import report_from_json
from app.photogrammetry.report import AdjustmentReport
from app.photogrammetry.survey import adjust_survey
from tests.photogrammetry.survey_scene import (
    PLATE,
    build_room,
    control_points,
    ring_of_stations,
    survey_photos,
)


@pytest.fixture(scope="module")
def report() -> AdjustmentReport:
    room = build_room(5)
    *points, unseen = control_points(room, ((102, "A"), (107, "B"), (112, "C"), (117, "centre"), (118, "A")))
    points.append(replace(unseen, code=700))
    return adjust_survey(survey_photos(room, ring_of_stations(10)), points, PLATE).report


def test_a_report_survives_its_json(report: AdjustmentReport) -> None:
    text = json.dumps(report.to_json())
    again = report_from_json(json.loads(text))
    assert json.dumps(again.to_json()) == text
    assert again.control[-1].residual_m is None
    assert again.image_residuals[0].counts.dtype == report.image_residuals[0].counts.dtype


def test_members_of_others_are_passed_over(report: AdjustmentReport) -> None:
    assert report_from_json({**report.to_json(), "extension": {}}).sigma0 == report.sigma0


@pytest.mark.parametrize("broken", [{}, {"photos": 3}, {"datum": None}])
def test_another_thing_is_no_report(report: AdjustmentReport, broken: dict[str, object]) -> None:
    record = {**report.to_json(), **broken} if broken else {"sigma0": 0.97}
    with pytest.raises(ValueError, match="no adjustment report"):
        report_from_json(record)
