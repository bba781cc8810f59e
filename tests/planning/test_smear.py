import numpy as np
import pytest

from app.geometry.pose import Pose
from app.planning.posting import UP, pose_facing
from app.planning.scene import Panel, Scene
from app.planning.smear import NOTHING_AHEAD_M, distance_ahead_m, motion_px
from app.planning.surfaces import PlainSurface
from app.planning.survey_plan import look_at, phone_camera

WALL = Panel(pose_facing(np.array([0.0, -1.0, 0.0]), UP, np.array([0.0, 4.0, 1.5])), 3.0, 3.0, PlainSurface((9, 9, 9)))
SCENE = Scene((), (WALL,))
CAMERA = phone_camera(640, 480)


def looking_north(x_m: float, heading_rad: float = 0.0) -> Pose:
    position_m = np.array([x_m, 0.0, 1.5])
    return look_at(position_m, position_m + np.array([np.sin(heading_rad), np.cos(heading_rad), 0.0]))


def test_the_wall_ahead_is_met_and_nothing_beside_it() -> None:
    assert distance_ahead_m(SCENE, looking_north(0.0)) == pytest.approx(4.0)
    assert distance_ahead_m(SCENE, looking_north(2.0)) == NOTHING_AHEAD_M
    assert distance_ahead_m(SCENE, looking_north(0.0, np.pi)) == NOTHING_AHEAD_M


def test_a_step_aside_moves_the_picture_by_focal_length_over_distance() -> None:
    moved_px = motion_px(SCENE, CAMERA, (looking_north(-0.01), looking_north(0.0), looking_north(0.01)))
    assert moved_px == pytest.approx((-CAMERA.fx_px * 0.02 / 4.0, 0.0), rel=1e-3, abs=1e-2)


def test_a_turn_moves_it_by_focal_length_times_angle_however_far() -> None:
    turn = (looking_north(2.0, -0.005), looking_north(2.0), looking_north(2.0, 0.005))
    assert motion_px(SCENE, CAMERA, turn) == pytest.approx((-CAMERA.fx_px * 0.01, 0.0), rel=1e-2, abs=1e-2)
