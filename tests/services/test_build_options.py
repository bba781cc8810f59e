from __future__ import annotations

import json
from typing import get_args

import pytest

from app.errors import InvalidInput
from app.services.build_options import BuildOptions, Exclusion, Strictness
from app.services.build_request import request_build
from app.services.detect_work import DetectSettings
from app.storage.database import Database
from tests.storage.test_sites import POINTS


def test_options_travel_through_a_jobs_row() -> None:
    options = BuildOptions(Exclusion(("a.jpg",), (389,), ("CP1",)), "eager", False, 3, "paper")
    assert BuildOptions.from_json(json.loads(json.dumps(options.to_json()))) == options
    assert BuildOptions.from_json(json.loads(json.dumps(BuildOptions().to_json()))) == BuildOptions()


def test_excluded_points_and_targets_take_no_part() -> None:
    assert Exclusion().points_left(POINTS) == POINTS
    assert [point.name for point in Exclusion(control_points=("CP1",)).points_left(POINTS)] == ["CP2"]
    assert Exclusion(codes=(389,)).points_left(POINTS) == ()


def test_detections_are_kept_apart_by_all_that_changes_them() -> None:
    options = [BuildOptions(strictness=strictness) for strictness in get_args(Strictness)]
    options.append(BuildOptions(strictness="strict", detector="paper"))
    settings = [DetectSettings.of(family, option) for family in ("golay", "full") for option in options]
    keys = [one.key("a" * 64) for one in settings]
    assert len(set(keys)) == len(settings) == 8
    assert [one.key("a" * 64) for one in settings] == keys


def test_the_published_method_cannot_be_asked_to_mend(database: Database) -> None:
    with database.writing() as session, pytest.raises(InvalidInput, match="mends no misread dot"):
        request_build(session, "no survey is looked up", BuildOptions(detector="paper"))
