from __future__ import annotations

import json

from app.services.build_options import BuildOptions, Exclusion
from app.services.detect_work import DetectSettings
from tests.storage.test_sites import POINTS


def test_options_travel_through_a_jobs_row() -> None:
    options = BuildOptions(Exclusion(("a.jpg",), (389,), ("CP1",)), "eager", False, 3)
    assert BuildOptions.from_json(json.loads(json.dumps(options.to_json()))) == options
    assert BuildOptions.from_json(json.loads(json.dumps(BuildOptions().to_json()))) == BuildOptions()


def test_excluded_points_and_targets_take_no_part() -> None:
    assert Exclusion().points_left(POINTS) == POINTS
    assert [point.name for point in Exclusion(control_points=("CP1",)).points_left(POINTS)] == ["CP2"]
    assert Exclusion(codes=(389,)).points_left(POINTS) == ()


def test_detections_are_kept_apart_by_all_that_changes_them() -> None:
    keys = {
        DetectSettings(family, strictness).key("a" * 64)
        for family in ("golay", "full")
        for strictness in ("strict", "normal", "eager")
    }  # fmt: skip
    assert len(keys) == 6
    assert DetectSettings("golay", "normal").key("a" * 64) == DetectSettings("golay", "normal").key("a" * 64)
