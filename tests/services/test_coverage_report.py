"""Heat maps: round classes with units, runs of one colour, all that was predicted in the record."""

from __future__ import annotations

import json

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.planning.plan_fields import fields_of_text
from app.planning.plan_file import plan_of_fields
from app.planning.planned_map import planned_map
from app.planning.predicted_views import Seeing
from app.planning.suggestions import SuggestionOptions
from app.services.coverage_report.classes import INKS, NOT_LOCATED, class_of, names_of, round_edges_m
from app.services.coverage_report.heat_map import draw_heat_map
from app.services.coverage_report.prediction import Prediction, predict, prediction_file
from app.services.reporting.drawing import Label

TEXT = b"{name: Office, room_m: [5, 4, 2.6], post: {count: 16}, view: {step_m: 1, headings: 4}}"
PLAN = plan_of_fields(fields_of_text(TEXT, "office"), "office")
ASKED = Prediction(
    PLAN.name,
    planned_map(PLAN),
    PLAN.walls,
    Seeing(PLAN.camera, PLAN.view.limits),
    PLAN.view,
    SuggestionOptions(count=1),
)


@given(st.lists(st.floats(1e-5, 100.0), min_size=1, max_size=50))
def test_edges_are_round_and_ascend(radii_m: list[float]) -> None:
    edges_m = round_edges_m(np.array([*radii_m, np.inf]))
    assert len(edges_m) == len(INKS) - 1 and (np.diff(edges_m) > 0).all()
    assert {f"{edge_m:e}"[0] for edge_m in edges_m} <= {"1", "2", "5"}
    classes = class_of(np.array([*radii_m, np.inf]), edges_m)
    assert classes[-1] == NOT_LOCATED and (classes[:-1] < NOT_LOCATED).all()
    assert len(names_of(edges_m)) == len(INKS)


def test_the_picture_says_what_it_shows() -> None:
    material = predict(ASKED)
    texts = [shape.text for shape in draw_heat_map(material).shapes if isinstance(shape, Label)]
    assert texts[0] == "Office" and "X, m" in texts and "suggested, in order" in texts
    assert any(text.startswith("At the worst of 4 headings: ") for text in texts)
    assert sum(text.endswith(" mm") for text in texts) >= len(INKS)


def test_the_record_holds_each_position() -> None:
    material = predict(ASKED)
    record = json.loads(prediction_file(ASKED, material, "json"))
    assert len(record["positions"]) == record["summary"]["positions"] == 20
    for position, radii_m in zip(record["positions"], material.coverage.radii95_m, strict=True):
        assert [radius is None for radius in position["radii95_m"]] == np.isinf(radii_m).tolist()
