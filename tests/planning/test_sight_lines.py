"""Sight lines: walls hide from both sides, backs and slants are not seen, places behind walls are none."""

from __future__ import annotations

import numpy as np

from app.planning.plan_fields import fields_of_text
from app.planning.plan_file import Plan, plan_of_fields
from app.planning.plan_view import SightLimits
from app.planning.planned_map import planned_map
from app.planning.sight_lines import find_sight_lines, lie_open

FAR = (1e6, SightLimits(max_incidence_deg=80.0))  # no size refuses


def plan_of(text: str) -> Plan:
    return plan_of_fields(fields_of_text(text.encode(), "plan"), "plan")


ROOM = plan_of(
    "{room_m: [6, 4, 3], walls: [{from_m: [3, 0], to_m: [3, 2], height_m: 2}], post: {count: 20, walls: [south]}}"
)


def test_a_partition_hides_what_is_behind_it() -> None:
    targets = planned_map(ROOM).targets
    place_m = np.array([[1.0, 1.0, 1.5]])
    with_partition = set(find_sight_lines(place_m, targets, ROOM.walls, FAR).of(0).tolist())
    without = set(find_sight_lines(place_m, targets, ROOM.walls[:-1], FAR).of(0).tolist())
    beyond = {index for index, target in enumerate(targets) if target.site_from_target.position_m[0] > 3}
    assert with_partition == without - beyond and beyond & without


def test_over_a_partition_one_sees() -> None:
    targets = planned_map(ROOM).targets
    high_m = np.array([[2.9, 1.0, 2.9]])
    seen = find_sight_lines(high_m, targets, ROOM.walls, FAR).of(0)
    assert any(targets[index].site_from_target.position_m[0] > 3 for index in seen)


def test_backs_slants_and_small_plates_are_not_seen() -> None:
    targets = planned_map(ROOM).targets
    behind_m, aside_m, before_m = np.array([3.0, -2.0, 1.5]), np.array([3.0, 0.05, 1.5]), np.array([3.0, 3.0, 1.5])
    lines = find_sight_lines(np.array([behind_m, aside_m, before_m]), targets, (), FAR)
    assert len(lines.of(0)) == 0
    assert len(lines.of(1)) < len(lines.of(2)) == 20
    assert len(find_sight_lines(before_m[None], targets, (), (10.0, SightLimits())).of(0)) == 0


def test_places_in_pillars_behind_walls_and_near_walls_are_none() -> None:
    text = "{room_m: [6, 4, 3], walls: [{outline_m: [[2, 1], [3, 1], [3, 2], [2, 2]], height_m: 3, faces: outwards}]}"
    places_m = np.array([[1.0, 1.0, 1.5], [2.5, 1.5, 1.5], [-1.0, 2.0, 1.5], [7.0, 9.0, 1.5], [5.9, 2.0, 1.5]])
    np.testing.assert_array_equal(lie_open(places_m, plan_of(text).walls, 0.25), [True, False, False, False, False])
