"""What is false is found, named and left out: misread, moved, doubled, bent and wrongly printed targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.geometry.pose import Pose
from app.photogrammetry.report import AdjustmentReport
from app.photogrammetry.survey import SurveyPhoto, SurveyResult, adjust_survey
from app.targets.layout import dots_target_m
from tests.photogrammetry.survey_scene import (
    CONTROL_DOTS,
    PLATE,
    U_M,
    Room,
    build_room,
    control_points,
    dot_errors_m,
    ring_of_stations,
    survey_photos,
)

ROOM = build_room()
STATIONS = ring_of_stations(24)
# Noise of 0.1 px at 1400 px and 5 m is 0.4 mm across the ray; along it, with few rays, some times that.
GOOD_M = 0.004


def adjusted(photos: Sequence[SurveyPhoto]) -> SurveyResult:
    return adjust_survey(photos, control_points(ROOM, CONTROL_DOTS), PLATE)


def left_out(report: AdjustmentReport, code: int) -> str:
    return next(f"{record.reason}: {record.detail}" for record in report.left_out if record.code == code)


def assert_rest_is_good(result: SurveyResult, room: Room = ROOM) -> None:
    assert np.abs(dot_errors_m(room, result.target_map.targets)).max() < GOOD_M


def test_a_misread_target_is_named_with_its_photograph() -> None:
    photos = survey_photos(ROOM, STATIONS)
    target = photos[4].detection.targets[2]
    absent = min(set(ROOM.poses) - {seen.code for seen in photos[4].detection.targets})
    targets = tuple(replace(seen, code=absent) if seen is target else seen for seen in photos[4].detection.targets)
    photos[4] = replace(photos[4], detection=replace(photos[4].detection, targets=targets))
    result = adjusted(photos)
    assert [(record.photo, record.code) for record in result.report.false_sightings] == [("photo04.jpg", absent)]
    assert absent in result.target_map.by_code
    assert_rest_is_good(result)


def survey_of_two_states(before: Room, after: Room) -> list[SurveyPhoto]:
    """Every second photograph shows the room as it was later."""
    earlier, later = survey_photos(before, STATIONS), survey_photos(after, STATIONS)
    return [pair[number % 2] for number, pair in enumerate(zip(earlier, later, strict=True))]


@pytest.mark.parametrize("distance_m", [0.03, 0.5])
def test_a_target_that_was_moved_or_posted_twice_is_left_out(distance_m: float) -> None:
    pose = ROOM.poses[105]
    elsewhere = ROOM.with_pose(105, Pose(pose.rotation, pose.position_m + np.array([distance_m, 0.0, 0.0])))
    result = adjusted(survey_of_two_states(ROOM, elsewhere))
    words = left_out(result.report, 105)
    assert words.startswith("moved: stands in two places")
    # Four views of each place, 3 m away, of 0.1 px: the distance is good to a centimetre across and along the rays.
    assert float(words.split()[5]) == pytest.approx(distance_m, abs=0.01)
    assert 105 not in result.target_map.by_code
    assert_rest_is_good(result)


def test_a_plate_of_another_size_is_left_out() -> None:
    shrunk = ROOM.with_plate(125, dots_target_m(U_M, (0.96, 0.96)))
    result = adjusted(survey_photos(shrunk, STATIONS))
    assert left_out(result.report, 125).startswith("deformed: is printed at 96")
    assert_rest_is_good(result)


def test_a_bent_plate_is_left_out() -> None:
    plate_m = dots_target_m(U_M)
    plate_m[:, 2] = 0.005 * (plate_m[:, 0] / plate_m[:, 0].max()) ** 2  # its left and right edges stand 5 mm off
    result = adjusted(survey_photos(ROOM.with_plate(121, plate_m), STATIONS))
    assert left_out(result.report, 121).startswith("deformed: is bent")
    assert_rest_is_good(result)


def test_a_photograph_whose_codes_are_wrong_has_no_pose() -> None:
    photos = survey_photos(ROOM, STATIONS)
    codes = [seen.code for seen in photos[7].detection.targets]
    turned = [replace(seen, code=code) for seen, code in zip(photos[7].detection.targets, codes[::-1], strict=True)]
    photos[7] = replace(photos[7], detection=replace(photos[7].detection, targets=tuple(turned)))
    result = adjusted(photos)
    (name, reason), *others = result.unoriented
    assert name == "photo07.jpg"
    assert "do not agree" in reason
    assert not others
    assert_rest_is_good(result)


def test_a_photograph_of_another_zoom_spoils_only_itself() -> None:
    """Ten percent under the same EXIF: its pose takes up most of it, what does not fit is named."""
    photos = survey_photos(ROOM, STATIONS)
    wide = [
        replace(seen, centres_px=(seen.centres_px - [951.0, 547.0]) * 1.1 + [951.0, 547.0])
        for seen in photos[7].detection.targets
    ]
    photos[7] = replace(photos[7], detection=replace(photos[7].detection, targets=tuple(wide)))
    result = adjusted(photos)
    assert {record.photo for record in result.report.false_sightings} == {"photo07.jpg"}
    assert_rest_is_good(result)


def test_nothing_is_left_out_of_a_good_survey() -> None:
    report = adjusted(survey_photos(ROOM, STATIONS)).report
    assert not report.false_sightings
    assert not report.unoriented
    assert {record.reason for record in report.left_out} <= {"rays", "angle"}
