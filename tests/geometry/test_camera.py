from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera, CameraIdentity

WIDTH_PX, HEIGHT_PX = 1280, 720
# A phone's distortion, both signs: stronger than most, so that no term hides in rounding.
DISTORTIONS = [
    (0.0, 0.0, 0.0, 0.0, 0.0),
    (0.09, -0.19, 6e-4, -4e-4, 0.08),
    (-0.12, 0.08, -8e-4, 5e-4, -0.03),
]
cameras = st.sampled_from(
    [Camera(WIDTH_PX, HEIGHT_PX, np.array([950.0, 940.0, 645.2, 352.8, *terms])) for terms in DISTORTIONS]
)
image_points = st.tuples(st.floats(-0.5, WIDTH_PX - 0.5), st.floats(-0.5, HEIGHT_PX - 0.5)).map(np.array)
depths_m = st.floats(0.2, 20.0)


def point_seen_at(camera: Camera, image_px: np.ndarray, depth_m: float) -> np.ndarray:
    return np.append(camera.normalise(image_px), 1.0) * depth_m


@given(cameras, image_points, depths_m)
def test_normalise_inverts_project(camera: Camera, image_px: np.ndarray, depth_m: float) -> None:
    # 1e-4 px is far below any measurement; the fixed point's last step is the limit in the corners.
    np.testing.assert_allclose(camera.project(point_seen_at(camera, image_px, depth_m)), image_px, atol=1e-4)


@given(cameras, image_points, depths_m)
def test_projection_is_opencvs(camera: Camera, image_px: np.ndarray, depth_m: float) -> None:
    point_m = point_seen_at(camera, image_px, depth_m)
    fx, fy, cx, cy, *distortion = camera.intrinsics
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    expected_px, _ = cv2.projectPoints(point_m[None], np.zeros(3), np.zeros(3), matrix, np.array(distortion))
    np.testing.assert_allclose(camera.project(point_m), expected_px.ravel(), atol=1e-9)


@given(cameras, image_points, depths_m)
def test_jacobians_meet_central_differences(camera: Camera, image_px: np.ndarray, depth_m: float) -> None:
    point_m = point_seen_at(camera, image_px, depth_m)
    projected_px, by_point, by_intrinsics = camera.project_with_jacobians(point_m)
    np.testing.assert_allclose(projected_px, camera.project(point_m), atol=1e-9)
    step = 1e-6  # relative; the differences then err by about 1e-9 of the derivative's scale
    for axis in range(3):
        shift_m = np.eye(3)[axis] * step * depth_m
        difference = camera.project(point_m + shift_m) - camera.project(point_m - shift_m)
        np.testing.assert_allclose(
            by_point[:, axis], difference / (2 * step * depth_m), atol=1e-6 * camera.fx_px / depth_m
        )
    for index in range(INTRINSIC_COUNT):
        size = step * max(1.0, abs(camera.intrinsics[index]))
        shift = np.eye(INTRINSIC_COUNT)[index] * size
        plus, minus = (camera.with_intrinsics(camera.intrinsics + sign * shift) for sign in (1, -1))
        difference = plus.project(point_m) - minus.project(point_m)
        np.testing.assert_allclose(by_intrinsics[:, index], difference / (2 * size), atol=1e-6 * camera.fx_px)


def test_stacked_points_are_projected_one_by_one() -> None:
    camera = Camera(WIDTH_PX, HEIGHT_PX, np.array([950.0, 940.0, 645.2, 352.8, *DISTORTIONS[1]]))
    points_m = np.random.default_rng(7).uniform([-1, -0.5, 2], [1, 0.5, 4], (3, 4, 3))
    image_px, by_point, by_intrinsics = camera.project_with_jacobians(points_m)
    one_px, one_by_point, one_by_intrinsics = camera.project_with_jacobians(points_m[2, 1])
    np.testing.assert_allclose(image_px[2, 1], one_px)
    np.testing.assert_allclose(by_point[2, 1], one_by_point)
    np.testing.assert_allclose(by_intrinsics[2, 1], one_by_intrinsics)
    np.testing.assert_allclose(camera.normalise(image_px)[2, 1], camera.normalise(one_px))


@given(cameras, image_points, depths_m, st.sampled_from([1, 3]))
def test_a_turned_camera_sees_the_turned_picture(
    camera: Camera, image_px: np.ndarray, depth_m: float, quarter_turns: int
) -> None:
    point_m = point_seen_at(camera, image_px, depth_m)
    x_px, y_px = camera.project(point_m)
    x_m, y_m, z_m = point_m
    if quarter_turns == 1:  # clockwise: what was on the left is on top, what was below is on the left
        turned_px, turned_m = [HEIGHT_PX - 1 - y_px, x_px], np.array([-y_m, x_m, z_m])
    else:
        turned_px, turned_m = [y_px, WIDTH_PX - 1 - x_px], np.array([y_m, -x_m, z_m])
    turned = camera.turned(quarter_turns)
    assert (turned.width_px, turned.height_px) == (HEIGHT_PX, WIDTH_PX)
    np.testing.assert_allclose(turned.project(turned_m), turned_px, atol=1e-9)


def test_turning_follows_the_pixels_as_numpy_turns_them() -> None:
    picture = np.arange(6).reshape(2, 3)  # width 3, height 2; the pixel at (2, 0) holds 2
    clockwise = np.rot90(picture, -1)
    assert clockwise[2, 2 - 1 - 0] == picture[0, 2]  # new x = height - 1 - y, new y = x, as ``turned`` says


@given(cameras)
def test_a_turn_and_its_counter_turn_cancel(camera: Camera) -> None:
    np.testing.assert_allclose(camera.turned(1).turned(3).intrinsics, camera.intrinsics)


def test_half_turns_are_not_transposed_frames() -> None:
    with pytest.raises(ValueError, match="1 or 3"):
        Camera(4, 3, np.array([5.0, 5.0, 2.0, 1.5, 0, 0, 0, 0, 0])).turned(2)


@pytest.mark.parametrize(
    ("size_px", "intrinsics"),
    [
        ((640, 480), np.ones(8)),
        ((640, 480), np.full(9, np.nan)),
        ((0, 480), np.ones(9)),
        ((640, 480), np.array([-1.0, 1.0, 0, 0, 0, 0, 0, 0, 0])),
    ],
)
def test_what_is_no_camera_is_refused(size_px: tuple[int, int], intrinsics: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"nine finite|positive"):
        Camera(*size_px, intrinsics)


def test_calibrated_cameras_need_a_positive_covariance() -> None:
    camera = Camera(640, 480, np.array([600.0, 600.0, 320.0, 240.0, 0, 0, 0, 0, 0]))
    assert CalibratedCamera(camera, np.eye(9), "survey").camera == camera
    with pytest.raises(ValueError, match="9 x 9"):
        CalibratedCamera(camera, np.eye(8), "survey")
    with pytest.raises(ValueError, match="positive"):
        CalibratedCamera(camera, np.diag([1.0] * 8 + [0.0]), "survey")


@pytest.mark.parametrize(
    "change",
    [
        {"make": "Other"},
        {"model": "Other"},
        {"width_px": 1},
        {"height_px": 1},
        {"focal_mm": 5.0},
        {"focal_35mm": None},
        {"lens": "tele"},
        {"zoom": 2.0},
    ],
)
def test_the_key_tells_cameras_and_their_settings_apart(change: dict[str, object]) -> None:
    identity = CameraIdentity("HUAWEI", "VTR-L09", 1920, 1080, focal_mm=3.95, focal_35mm=27.0)
    assert replace(identity).key == identity.key
    assert replace(identity, **change).key != identity.key  # type: ignore[arg-type]
