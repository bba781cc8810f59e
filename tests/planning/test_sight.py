import cv2
import numpy as np
import pytest

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.scene import Panel, PostedTarget, Scene
from app.planning.sight import see
from app.planning.surfaces import PlainSurface
from app.planning.survey_plan import phone_camera
from app.targets.layout import dots_target_m

U_M = 0.014
CAMERA = phone_camera(640, 480)
AT_ORIGIN = Pose(np.eye(3), np.zeros(3))
TOWARDS_CAMERA = np.diag([1.0, -1.0, -1.0])


def target_at(position_m: tuple[float, float, float], turn: np.ndarray | None = None) -> PostedTarget:
    rotation = exp_rotation(np.zeros(3) if turn is None else turn) @ TOWARDS_CAMERA
    return PostedTarget(389, Pose(rotation, np.array(position_m)), U_M)


def test_dots_fall_where_opencv_projects_them() -> None:
    target = target_at((0.2, -0.1, 1.5), np.array([0.3, -0.5, 0.1]))
    (seen,) = see(Scene((target,), ()), CAMERA, AT_ORIGIN)
    fx, fy, cx, cy, *distortion = CAMERA.intrinsics
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    expected_px, _ = cv2.projectPoints(target.dots_m(), np.zeros(3), np.zeros(3), matrix, np.array(distortion))
    np.testing.assert_allclose(seen.dots_px, expected_px[:, 0], atol=1e-9)
    assert seen.whole and not seen.wrong


def test_size_and_incidence_are_those_of_their_definition() -> None:
    (seen,) = see(Scene((target_at((0.0, 0.0, 2.0), np.array([0.0, 0.7, 0.0])),), ()), CAMERA, AT_ORIGIN)
    assert seen.px_per_u == pytest.approx(CAMERA.fx_px * U_M / 2.0)
    assert seen.incidence_deg == pytest.approx(np.degrees(0.7))


def test_a_cupboard_hides_the_dots_behind_it_and_no_others() -> None:
    # Its right edge at half the distance covers what lies left of the optical axis.
    cupboard = Panel(Pose(TOWARDS_CAMERA, np.array([-0.5, 0.0, 1.0])), 1.0, 1.0, PlainSurface((9, 9, 9)))
    (seen,) = see(Scene((target_at((0.0, 0.0, 2.0)),), (cupboard,)), CAMERA, AT_ORIGIN)
    np.testing.assert_array_equal(seen.hidden, dots_target_m(U_M)[:, 0] < 0)


def test_a_dot_partly_hidden_is_hidden() -> None:
    edge_m = (dots_target_m(U_M)[1, 0] + 0.9 * U_M) / 2  # through the rims of the second column, right of the middles
    cupboard = Panel(Pose(TOWARDS_CAMERA, np.array([edge_m - 0.5, 0.0, 1.0])), 1.0, 1.0, PlainSurface((9, 9, 9)))
    (seen,) = see(Scene((target_at((0.0, 0.0, 2.0)),), (cupboard,)), CAMERA, AT_ORIGIN)
    assert seen.hidden.reshape(4, 4).tolist() == [[True, True, False, False]] * 4
    further = Panel(Pose(TOWARDS_CAMERA, np.array([edge_m - 0.48 * U_M - 0.5, 0.0, 1.0])), 1.0, 1.0, cupboard.surface)
    (seen,) = see(Scene((target_at((0.0, 0.0, 2.0)),), (further,)), CAMERA, AT_ORIGIN)
    assert seen.hidden.reshape(4, 4).tolist() == [[True, True, False, False]] * 4


def test_the_wall_behind_and_the_back_of_a_board_hide_nothing() -> None:
    wall = Panel(Pose(TOWARDS_CAMERA, np.array([0.0, 0.0, 2.0])), 4.0, 4.0, PlainSurface((9, 9, 9)))
    back = Panel(Pose(np.eye(3), np.array([0.0, 0.0, 1.0])), 4.0, 4.0, PlainSurface((9, 9, 9)))
    (seen,) = see(Scene((target_at((0.0, 0.0, 2.0)),), (wall, back)), CAMERA, AT_ORIGIN)
    assert seen.whole


def test_dots_out_of_the_frame_are_hidden_and_targets_outside_are_not_seen() -> None:
    half_width_m = 2.0 * 320 / CAMERA.fx_px
    (seen,) = see(Scene((target_at((half_width_m, 0.0, 2.0)),), ()), CAMERA, AT_ORIGIN)
    assert 0 < seen.hidden.sum() < 16
    np.testing.assert_array_equal(seen.hidden, seen.dots_px[:, 0] > 630)
    assert see(Scene((target_at((5.0, 0.0, 2.0)),), ()), CAMERA, AT_ORIGIN) == ()


def test_targets_behind_or_turned_away_are_not_seen() -> None:
    behind = target_at((0.0, 0.0, -2.0))
    away = target_at((0.0, 0.0, 2.0), np.array([0.0, np.pi, 0.0]))
    assert see(Scene((behind, away), ()), CAMERA, AT_ORIGIN) == ()
