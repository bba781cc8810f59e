import numpy as np

from app.geometry.camera import UNDISTORT_STEPS
from app.geometry.kernels.lens import linearise_projection, project
from app.geometry.kernels.undistortion import normalise_points
from app.planning.survey_plan import phone_camera

CAMERA = phone_camera(1920, 1080)
POINTS_M = np.random.default_rng(1).uniform([-1.0, -0.6, 1.5], [1.0, 0.6, 4.0], (50, 3))


def test_points_are_projected_and_differentiated_as_the_camera_does() -> None:
    image_px, by_points, by_intrinsics = CAMERA.project_with_jacobians(POINTS_M)
    by_point, by_camera = np.empty((2, 3)), np.empty((2, 9))
    for place, point_m in enumerate(POINTS_M):
        at_px = linearise_projection(CAMERA.intrinsics, point_m, by_point, by_camera)
        np.testing.assert_allclose(at_px, image_px[place], rtol=1e-12)
        np.testing.assert_allclose(project(CAMERA.intrinsics, *point_m), image_px[place], rtol=1e-12)
        np.testing.assert_allclose(by_point, by_points[place], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(by_camera, by_intrinsics[place], rtol=1e-9, atol=1e-9)


def test_pixels_are_undistorted_as_the_camera_does() -> None:
    image_px = CAMERA.project(POINTS_M)
    normalised = np.empty_like(image_px)
    normalise_points(CAMERA.intrinsics, image_px, UNDISTORT_STEPS, normalised)
    np.testing.assert_allclose(normalised, CAMERA.normalise(image_px), atol=1e-12)
    np.testing.assert_allclose(normalised, POINTS_M[:, :2] / POINTS_M[:, 2:], atol=1e-6)
