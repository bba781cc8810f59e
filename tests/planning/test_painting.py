from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.painting import PaintingOptions, paint
from app.planning.posting import pose_facing
from app.planning.scene import Gloss, Lamp, Panel, PostedTarget, Scene
from app.planning.surfaces import PAPER_ALBEDO, PlainSurface
from app.planning.tone import linear_of_srgb
from app.targets.drawing import BLACK_RGB
from app.targets.layout import dot_centres_u, dots_target_m

U_M = 0.014
AT_ORIGIN = Pose(np.eye(3), np.zeros(3))
DISTORTED = Camera(400, 300, np.array([460.0, 455.0, 203.4, 147.1, 0.09, -0.187, 6e-4, -4e-4, 0.08]))
MEASURED_CELLS = (5, 10)  # two dots alone on a black plate: nothing else within 4 u
SMOOTHING_PX = 1.0  # as a lens does: moments of a sharp, sampled edge are rough by themselves
TOWARDS_CAMERA = np.diag([1.0, -1.0, -1.0])


def lone_dots(pose: Pose) -> Scene:
    cells_rgb = np.broadcast_to(np.array(BLACK_RGB, dtype=np.uint8), (16, 3)).copy()
    cells_rgb[list(MEASURED_CELLS)] = 255
    # Ambient light alone, and a sheet that ends with the plate.
    return Scene((PostedTarget(389, pose, U_M, paper_margin_u=0.0, wrong_cells_rgb=cells_rgb),), ())


def centroid_of_projected_disc(camera: Camera, pose: Pose, cell: int) -> np.ndarray:
    """Centre of mass of a dot's image, from 2,000 points of its rim; not the image of its centre."""
    angle = np.arange(2_000) * 2 * np.pi / 2_000
    rim_m = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(2_000)]) * U_M + dots_target_m(U_M)[cell]
    x, y = camera.project(pose.apply(rim_m)).T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    return np.array([(x + np.roll(x, -1)) @ cross, (y + np.roll(y, -1)) @ cross]) / (3 * cross.sum())


def moment(picture: np.ndarray, camera: Camera, pose: Pose, cell: int) -> np.ndarray:
    """Centre of mass of the light above the plate's black, within 2.1 u of the dot as seen on the plate."""
    rows, columns = np.mgrid[0 : camera.height_px, 0 : camera.width_px]
    rays = np.append(camera.normalise(np.stack([columns, rows], -1).astype(float)), np.ones((*rows.shape, 1)), axis=2)
    plane = rays @ np.linalg.inv(np.column_stack([pose.rotation[:, :2], pose.position_m])).T
    away_u = plane[..., :2] / plane[..., 2:] / U_M - dot_centres_u()[cell]
    light = picture - PAPER_ALBEDO * linear_of_srgb(BLACK_RGB)[1]
    weight = np.where(np.hypot(*np.moveaxis(away_u, -1, 0)) < 2.1, light, 0.0)
    return np.array([(weight * columns).sum(), (weight * rows).sum()]) / weight.sum()


@settings(max_examples=12, deadline=None)
@given(
    distance_m=st.floats(0.8, 2.4),  # 8 ... 2.7 px per u
    slant_deg=st.floats(0.0, 50.0),
    towards_rad=st.floats(0.0, 6.3),
    roll_rad=st.floats(0.0, 6.3),
    aside=st.tuples(st.floats(-0.25, 0.25), st.floats(-0.18, 0.18)),
)
def test_dots_are_painted_where_the_camera_projects_them(
    distance_m: float, slant_deg: float, towards_rad: float, roll_rad: float, aside: tuple[float, float]
) -> None:
    slant = exp_rotation(np.radians(slant_deg) * np.array([np.cos(towards_rad), np.sin(towards_rad), 0.0]))
    rotation = slant @ TOWARDS_CAMERA @ exp_rotation(np.array([0.0, 0.0, roll_rad]))
    pose = Pose(rotation, np.array([*aside, 1.0]) * distance_m)
    painted = paint(lone_dots(pose), DISTORTED, AT_ORIGIN)[..., 1].astype(np.float64)
    picture = cv2.GaussianBlur(painted, (0, 0), SMOOTHING_PX)
    for cell in MEASURED_CELLS:
        expected_px = centroid_of_projected_disc(DISTORTED, pose, cell)
        np.testing.assert_allclose(moment(picture, DISTORTED, pose, cell), expected_px, atol=0.01)


def test_the_scene_is_the_same_from_wherever_it_is_described() -> None:
    target_pose = Pose(TOWARDS_CAMERA, np.array([0.1, 0.0, 1.5]))
    moved = Pose(exp_rotation(np.array([0.4, -1.0, 0.3])), np.array([5.0, -3.0, 1.0]))
    here = paint(lone_dots(target_pose), DISTORTED, AT_ORIGIN)
    there = paint(lone_dots(moved.compose(target_pose)), DISTORTED, moved)
    np.testing.assert_allclose(there, here, atol=1e-5)


def facing_camera(z_m: float, width_m: float, rgb: tuple[int, int, int]) -> Panel:
    return Panel(Pose(TOWARDS_CAMERA, np.array([0.0, 0.0, z_m])), width_m, width_m, PlainSurface(rgb))


def test_the_nearer_panel_hides_the_farther() -> None:
    picture = paint(
        Scene((), (facing_camera(1.0, 0.2, (255, 0, 0)), facing_camera(2.0, 4.0, (0, 255, 0)))), DISTORTED, AT_ORIGIN
    )
    np.testing.assert_allclose(picture[147, 203], [1.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(picture[10, 10], [0.0, 1.0, 0.0], atol=1e-6)


def test_a_pixel_is_the_mean_of_what_falls_on_it() -> None:
    camera = Camera(40, 30, np.array([100.0, 100.0, 20.0, 15.0, 0, 0, 0, 0, 0]))
    # The sheet's right edge lies at column 22.75: the pixel's share of it is a quarter.
    sheet_m = 2 * 0.0275
    target = PostedTarget(1, Pose(TOWARDS_CAMERA, np.array([0.0, 0.0, 1.0])), sheet_m / 26.0, paper_margin_u=6.5)
    picture = paint(Scene((target,), (), ambient_rgb=(1.0, 1.0, 1.0)), camera, AT_ORIGIN)
    assert picture[15, 22, 0] == pytest.approx(PAPER_ALBEDO, abs=1e-6)
    assert picture[15, 23, 0] == pytest.approx(0.25 * PAPER_ALBEDO + 0.75, abs=1e-6)


def test_lamps_obey_the_inverse_square_and_the_cosine() -> None:
    lamp = Lamp(np.array([0.3, 0.0, 0.0]), (2.0, 1.0, 0.5))
    scene = Scene((), (facing_camera(2.0, 4.0, (255, 255, 255)),), (lamp,), (0.0, 0.0, 0.0))
    camera = Camera(41, 31, np.array([50.0, 50.0, 20.0, 15.0, 0, 0, 0, 0, 0]))
    distance2_m2 = 0.3**2 + 2.0**2
    expected = np.array([2.0, 1.0, 0.5]) / distance2_m2 * 2.0 / np.sqrt(distance2_m2)
    np.testing.assert_allclose(paint(scene, camera, AT_ORIGIN)[15, 20], expected, rtol=1e-5)


def test_cutting_the_work_into_bands_changes_nothing() -> None:
    scene = lone_dots(Pose(TOWARDS_CAMERA, np.array([0.1, 0.0, 0.7])))
    banded = paint(scene, DISTORTED, AT_ORIGIN, PaintingOptions(samples_at_once=5_000))
    np.testing.assert_array_equal(banded, paint(scene, DISTORTED, AT_ORIGIN))


def test_a_camera_in_the_open_sees_the_ambient_light() -> None:
    wall_behind = Panel(
        pose_facing(np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])),
        1.0,
        1.0,
        PlainSurface((9, 9, 9)),
    )
    picture = paint(Scene((), (wall_behind,), ambient_rgb=(0.1, 0.2, 0.3)), DISTORTED, AT_ORIGIN)
    np.testing.assert_allclose(picture, np.broadcast_to(np.float32([0.1, 0.2, 0.3]), picture.shape))


def test_a_film_mirrors_a_lamp_where_the_angles_are_equal_and_a_window_glows_by_itself() -> None:
    lamp = Lamp(np.array([0.4, 0.0, 0.0]), (1.0, 1.0, 1.0))
    wall = facing_camera(2.0, 4.0, (0, 0, 0))
    film = replace(wall, gloss=Gloss(reflectance=0.04, sharpness=5_000.0))
    camera = Camera(41, 31, np.array([50.0, 50.0, 20.0, 15.0, 0, 0, 0, 0, 0]))
    picture = paint(Scene((), (film,), (lamp,), (0.0, 0.0, 0.0)), camera, AT_ORIGIN)[..., 0]
    # Half-way to the lamp, 0.2 m aside at a distance of 2 m: 5 px.
    assert np.unravel_index(picture.argmax(), picture.shape) == (15, 25)
    assert picture[15, 25] == pytest.approx(0.04 * 5_008 / 8 * 2.0 / (4.0 + 0.2**2) ** 1.5, rel=1e-4)
    assert picture[0, 0] == 0.0
    window = replace(wall, glow_rgb=(3.0, 2.0, 1.0))
    np.testing.assert_allclose(
        paint(Scene((), (window,), (), (1.0, 1.0, 1.0)), camera, AT_ORIGIN)[15, 20], [3.0, 2.0, 1.0]
    )


@pytest.mark.parametrize(("reflectance", "sharpness"), [(-0.1, 1.0), (1.1, 1.0), (0.5, 0.0)])
def test_a_film_that_cannot_be_is_refused(reflectance: float, sharpness: float) -> None:
    with pytest.raises(ValueError, match="gloss"):
        Gloss(reflectance, sharpness)
