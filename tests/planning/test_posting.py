from dataclasses import replace

import numpy as np
import pytest

from app.planning.posting import PROUD_M, RoomOptions, pose_facing
from app.planning.room import build_room
from app.planning.scene import PostedTarget
from app.targets.drawing import RED_RGB, cell_colours_rgb
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS, PLATE_SIDE_U

GOLAY = family_by_name("golay")
OPTIONS = RoomOptions(targets=30, wrong_targets=3)


def wall_of(target: PostedTarget) -> int:
    x, y, _ = target.site_from_target.position_m
    return int(np.argmin([y, OPTIONS.size_m[0] - x, OPTIONS.size_m[1] - y, x]))


def test_plates_hang_on_the_walls_askew_but_upright_and_apart() -> None:
    targets = build_room(OPTIONS, GOLAY, seed=3).targets
    normals = np.array([[0, 1, 0], [-1, 0, 0], [0, -1, 0], [1, 0, 0]])
    for target in targets:
        pose = target.site_from_target
        np.testing.assert_allclose(pose.rotation[:, 2], normals[wall_of(target)], atol=1e-12)
        assert OPTIONS.heights_m[0] <= pose.position_m[2] <= OPTIONS.heights_m[1]
        assert pose.rotation[2, 1] >= np.cos(np.radians(OPTIONS.roll_deg)) - 1e-12
    for index, target in enumerate(targets):
        for other in targets[:index]:
            away_m = np.linalg.norm(target.site_from_target.position_m - other.site_from_target.position_m)
            assert wall_of(target) != wall_of(other) or away_m > PLATE_SIDE_U * OPTIONS.u_m
    walls = [wall_of(target) for target in targets]
    assert set(walls) == {0, 1, 2, 3}


def test_paper_stands_a_little_off_its_wall() -> None:
    target = build_room(replace(OPTIONS, walls=(0,)), GOLAY, seed=3).targets[0]
    assert target.site_from_target.position_m[1] == pytest.approx(PROUD_M)


def test_codes_are_of_the_family_and_unique() -> None:
    targets = build_room(OPTIONS, GOLAY, seed=3).targets
    codes = [target.code for target in targets]
    assert len(set(codes)) == len(codes) == 33
    assert all(GOLAY.contains(code) for code in codes)


def test_wrong_plates_come_last_and_have_e_off_the_diagonals() -> None:
    targets = build_room(OPTIONS, GOLAY, seed=3).targets
    assert [target.wrong for target in targets] == [False] * 30 + [True] * 3
    for target in targets[30:]:
        assert target.wrong_cells_rgb is not None
        red = np.flatnonzero((target.wrong_cells_rgb == RED_RGB).all(axis=1))
        assert len(red) == 5 and set(BASE_CELLS[:4]) < set(red.tolist())
        row, column = divmod(int((set(red.tolist()) - set(BASE_CELLS[:4])).pop()), 4)
        assert row != column and row + column != 3
        assert sorted(map(tuple, target.wrong_cells_rgb)) == sorted(map(tuple, cell_colours_rgb(target.code)))


def test_full_walls_are_named() -> None:
    with pytest.raises(ValueError, match="no room for 100 plates"):
        build_room(RoomOptions(targets=100, walls=(0,)), GOLAY, seed=1)


def test_roll_turns_a_panel_counter_clockwise_as_seen_from_its_front() -> None:
    pose = pose_facing(np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.zeros(3), np.pi / 2)
    np.testing.assert_allclose(pose.rotation @ [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], atol=1e-12)
