"""Extending a map by a second survey of synthetic photographs: moved anchors are let go of, the frame stays."""

from __future__ import annotations

import numpy as np
import pytest

from app.errors import InvalidControlPoints
from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap
from app.photogrammetry.survey import adjust_survey
from app.services.extend_map import ExtendOptions, anchors_of, extend_map
from app.services.tied_survey import Tie, adjust_tied
from tests.photogrammetry.survey_scene import (
    CONTROL_DOTS,
    PLATE,
    Room,
    build_room,
    control_points,
    ring_of_stations,
    survey_photos,
)

ROOM = build_room()
STATIONS = ring_of_stations(16)
MOVED_M = 0.04
NEW_CODES = (108, 116, 124, 132)  # hung after the first survey


@pytest.fixture(scope="module")
def base() -> TargetMap:
    """A map of the room without the plates that come later."""
    early = Room({code: pose for code, pose in ROOM.poses.items() if code not in NEW_CODES}, ROOM.plates_m)
    return adjust_survey(survey_photos(early, STATIONS), control_points(early, CONTROL_DOTS), PLATE).target_map


def moved_room(codes: tuple[int, ...]) -> Room:
    room = ROOM
    for code in codes:
        pose = room.poses[code]
        room = room.with_pose(code, Pose(pose.rotation, pose.position_m + MOVED_M * pose.rotation[:, 0]))
    return room


def anchor_codes(base: TargetMap, room: Room) -> tuple[int, ...]:
    photos = survey_photos(room, STATIONS, seed=7)
    return tuple(anchor.code for anchor in anchors_of(base, [photo.detection for photo in photos]))


@pytest.mark.parametrize("count", [0, 1, 2])
def test_moved_anchors_are_named_and_new_targets_stand_where_they_hang(base: TargetMap, count: int) -> None:
    moved = anchor_codes(base, ROOM)[2 : 2 + count]
    room = moved_room(moved)
    survey = adjust_tied(survey_photos(room, STATIONS, seed=7), Tie(base))
    extension = extend_map(base, survey.target_map, ())
    assert set(extension.moved) == set(moved)
    assert set(extension.added) <= set(NEW_CODES)
    assert extension.added
    assert extension.target_map.datum is base.datum
    for code in (*extension.added, *moved):
        target = extension.target_map.by_code[code]
        position_m = target.site_from_target.position_m
        covariance = target.covariance + base.datum.pose_covariance(position_m)
        error_m = position_m - room.poses[code].position_m
        # Chi-square of three: chance exceeds 28 once in 300,000; seven targets share one datum.
        assert error_m @ np.linalg.solve(covariance[:3, :3], error_m) < 28.0


def test_more_moved_anchors_than_may_be_are_refused(base: TargetMap) -> None:
    room = moved_room(anchor_codes(base, ROOM)[2:3])
    with pytest.raises(InvalidControlPoints, match="contradict"):
        adjust_tied(survey_photos(room, STATIONS, seed=7), Tie(base, options=ExtendOptions(most_moved_anchors=0)))
