import numpy as np

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.painting import paint
from app.planning.pillar import bent_dots_m, bent_panels
from app.planning.scene import Panel, Scene
from app.planning.surfaces import PAPER_ALBEDO, PlateSurface
from app.planning.tone import linear_of_srgb
from app.targets.drawing import BLACK_RGB, cell_colours_rgb
from app.targets.layout import dots_target_m

U_M, CODE = 0.02, 389
CAMERA = Camera(320, 240, np.array([300.0, 300.0, 160.0, 120.0, 0, 0, 0, 0, 0]))
FACING = Pose(np.diag([1.0, -1.0, -1.0]) @ exp_rotation(np.array([0.0, 0.3, 0.2])), np.array([0.02, 0.01, 0.8]))


def sheet() -> Panel:
    return Panel(FACING, 15 * U_M, 15 * U_M, PlateSurface.of_code(CODE, U_M))


def test_a_wide_pillar_bends_nothing() -> None:
    np.testing.assert_allclose(bent_dots_m(FACING, U_M, 1e6), FACING.apply(dots_target_m(U_M)), atol=1e-7)


def test_bent_dots_keep_their_distances_along_the_paper_and_stand_on_the_pillar() -> None:
    radius_m = 12 * U_M
    dots_m = FACING.inverse().apply(bent_dots_m(FACING, U_M, radius_m))
    from_axis_m = np.hypot(dots_m[:, 0], dots_m[:, 2] + radius_m)
    np.testing.assert_allclose(from_axis_m, radius_m)
    along_m = radius_m * np.arctan2(dots_m[:, 0], dots_m[:, 2] + radius_m)
    np.testing.assert_allclose(np.column_stack([along_m, dots_m[:, 1]]), dots_target_m(U_M)[:, :2], atol=1e-12)


def test_the_picture_shows_each_dot_where_the_truth_says_and_no_gap_between_strips() -> None:
    radius_m = 12 * U_M
    picture = paint(Scene((), bent_panels(sheet(), U_M, radius_m)), CAMERA, Pose(np.eye(3), np.zeros(3)))
    columns, rows = np.rint(CAMERA.project(bent_dots_m(FACING, U_M, radius_m))).astype(int).T
    expected = PAPER_ALBEDO * linear_of_srgb(cell_colours_rgb(CODE))
    np.testing.assert_allclose(picture[rows, columns], expected, atol=0.01)
    # Half-way between four dots there is black all along; through a gap the ambient light, 1, would show.
    between_m = bent_dots_m(FACING, U_M, radius_m).reshape(4, 4, 3)[1:3].mean(axis=0)
    way = np.linspace(0, 3, 200)
    along_m = np.column_stack([np.interp(way, np.arange(4), axis) for axis in between_m.T])
    columns, rows = np.rint(CAMERA.project(along_m)).astype(int).T
    black = float(PAPER_ALBEDO * linear_of_srgb(BLACK_RGB).max())
    assert picture[rows, columns].max() < 2 * black
