"""Control points: what is refused before and after the photographs are known, and what errors are found in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from app.errors import InvalidControlPoints
from app.geometry.control import ControlPoint
from app.photogrammetry.cleaning import CleanNetwork, clean_network
from app.photogrammetry.control import StandingTargets, check_control
from app.photogrammetry.growth import GrowthOptions
from app.photogrammetry.initial_network import grow_networks
from app.photogrammetry.quality import QualityOptions, standing_targets
from app.photogrammetry.site_network import SiteNetwork, SiteOptions, refer_to_site
from app.photogrammetry.survey import SurveyResult, adjust_survey
from app.photogrammetry.survey_input import read_survey
from tests.photogrammetry.survey_scene import (
    CHECK_DOTS,
    CONTROL_DOTS,
    PLATE,
    build_room,
    control_points,
    dot_errors_m,
    ring_of_stations,
    survey_photos,
)

ROOM = build_room()
PHOTOS = survey_photos(ROOM, ring_of_stations(12))
CONTROL = control_points(ROOM, CONTROL_DOTS, noise_m=0.0005)


def adjusted(points: Sequence[ControlPoint]) -> SurveyResult:
    return adjust_survey(PHOTOS, points, PLATE)


@cache
def clean() -> tuple[CleanNetwork, StandingTargets]:
    """The photographs' own network, which control points do not change."""
    survey = read_survey(PHOTOS, PLATE)
    (network,) = grow_networks(survey.problem, GrowthOptions(), [].append)
    found = clean_network(network, QualityOptions(), lambda: None)
    sightings = found.problem.sightings
    codes = survey.codes[found.part.targets]
    return found, standing_targets(codes, found.adjusted.network, sightings, QualityOptions())


def refused(points: Sequence[ControlPoint]) -> InvalidControlPoints:
    with pytest.raises(InvalidControlPoints) as caught:
        referred(points)
    return caught.value


def referred(points: Sequence[ControlPoint]) -> SiteNetwork:
    check_control(points)
    network, standing = clean()
    return refer_to_site(network, points, standing, SiteOptions(), lambda: None)


def shifted(point: ControlPoint, by_m: Sequence[float]) -> ControlPoint:
    return replace(point, position_m=point.position_m + by_m)


def test_good_control_is_believed() -> None:
    result = adjusted(CONTROL)
    assert not result.target_map.datum.assumed_scale
    assert np.abs(dot_errors_m(ROOM, result.target_map.targets)).max() < 0.005
    assert result.report.control_rmse_m is not None
    assert result.report.control_rmse_m < 0.003  # three sigmas of a point
    assert not result.report.warnings


@pytest.mark.parametrize("count", [1, 2])
def test_one_or_two_points_are_too_few(count: int) -> None:
    assert refused(CONTROL[:count]).fields["reason"] == "too-few"


def test_points_in_one_line_are_refused() -> None:
    place_m, along_m = CONTROL[0].position_m, np.array([0.9, 0.4, 0.2])
    line = [replace(point, position_m=place_m + number * along_m) for number, point in enumerate(CONTROL)]
    assert refused(line).fields["reason"] == "collinear"


@pytest.mark.parametrize(
    ("field", "value"), [("name", CONTROL[0].name), ("code", CONTROL[0].code), ("position_m", CONTROL[0].position_m)]
)
def test_what_occurs_twice_is_refused_by_name(field: str, value: object) -> None:
    twice = replace(CONTROL[1], **{field: value}, **({"dot": CONTROL[0].dot} if field == "code" else {}))
    error = refused([CONTROL[0], twice, *CONTROL[2:]])
    assert error.fields["reason"] == "duplicate"
    assert error.fields["points"] == [CONTROL[0].name, twice.name]


def test_points_on_targets_that_nobody_saw_are_named() -> None:
    unknown = [replace(point, code=900 + n) for n, point in enumerate(CONTROL[:2])]
    error = refused([*unknown, *CONTROL[2:]])
    assert error.fields["reason"] == "not-seen"
    assert error.fields["points"] == [point.name for point in unknown]


def test_one_unseen_point_is_only_warned_of() -> None:
    fifth = replace(CONTROL[0], name="fifth", code=900, position_m=CONTROL[0].position_m + 1.0)
    result = adjusted([*CONTROL, fifth])
    assert any("fifth" in warning for warning in result.report.warnings)
    assert next(record for record in result.report.control if record.name == "fifth").residual_m is None


@pytest.mark.parametrize("wrong", range(4))
@pytest.mark.parametrize("by_m", [(0.0, 0.0, 0.3), (0.1, 0.0, 0.0), (0.0, 10.0, 0.0)])
def test_a_mistyped_coordinate_is_found_by_name(wrong: int, by_m: tuple[float, float, float]) -> None:
    points = [shifted(point, by_m) if place == wrong else point for place, point in enumerate(CONTROL)]
    error = refused(points)
    assert error.fields["reason"] == "contradiction"
    assert {"kind": "mistyped", "points": [CONTROL[wrong].name]} in error.fields["suspects"]


@pytest.mark.parametrize("pair", [(0, 1), (0, 3), (2, 3)])
def test_two_exchanged_points_are_found_by_name(pair: tuple[int, int]) -> None:
    points = list(CONTROL)
    for place, other in (pair, pair[::-1]):
        points[place] = replace(CONTROL[place], position_m=CONTROL[other].position_m)
    error = refused(points)
    names = [CONTROL[place].name for place in pair]
    assert error.fields["suspects"][0] == {"kind": "swapped", "points": names}
    assert " and ".join(names) in error.detail


def test_a_survey_with_bad_control_is_refused() -> None:
    with pytest.raises(InvalidControlPoints):
        adjusted([shifted(CONTROL[0], (0.5, 0.2, 0.1)), *CONTROL[1:]])


def test_an_error_among_three_points_is_only_noticed() -> None:
    points = [shifted(CONTROL[0], (0.5, 0.2, 0.1)), *CONTROL[1:3]]
    error = refused(points)
    assert error.fields["suspects"] == []
    assert "three" in error.detail


def test_a_list_in_millimetres_is_told_from_an_error() -> None:
    points = [replace(point, position_m=1e3 * point.position_m, sigma_m=1.0) for point in CONTROL]
    error = refused(points)
    assert error.fields["reason"] == "scale"
    assert error.fields["ratio"] == pytest.approx(1e3, rel=0.05)


def test_control_that_is_worse_than_stated_is_weighted_and_warned_of() -> None:
    """All points off by 2 cm at random, with sigmas of 5 mm: no single error explains that."""
    points = control_points(ROOM, (*CONTROL_DOTS, *CHECK_DOTS), sigma_m=0.005, noise_m=0.02, seed=12)
    result = adjusted(points)
    assert any("worse than their sigmas" in warning for warning in result.report.warnings)


def test_a_rectangle_of_points_hides_half_a_turn_unless_a_point_checks_it() -> None:
    corners = [(101, "centre"), (108, "centre"), (117, "centre"), (124, "centre")]
    room = ROOM
    for (code, _), corner_m in zip(corners, [(0.5, 0), (5.5, 0), (5.5, 5), (0.5, 5)], strict=True):
        pose = room.poses[code]
        room = room.with_pose(code, replace(pose, position_m=np.array([*corner_m, 1.5])))
    photos = survey_photos(room, ring_of_stations(16))
    points = control_points(room, corners)
    warned = adjust_survey(photos, points, PLATE).report.warnings
    assert any("half a turn" in warning for warning in warned)
    check = control_points(room, [(112, "A")], role="check")
    assert not any("half a turn" in warning for warning in adjust_survey(photos, points + check, PLATE).report.warnings)
