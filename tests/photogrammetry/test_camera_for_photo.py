"""One camera at other image sizes: pixels move as the picture does, and the covariance with them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, Camera
from app.photogrammetry.camera_for_photo import cameras_for_photo, scaled, turned

INTRINSICS = np.array([1400.0, 1410.0, 950.0, 548.0, 0.09, -0.18, 6e-4, -9e-4, 0.05])
POINTS_M = np.array([[0.3, -0.2, 1.0], [-0.5, 0.25, 1.0], [0.0, 0.0, 1.0]])


def calibrated() -> CalibratedCamera:
    root = np.random.default_rng(2).normal(size=(9, 9)) * np.array([3, 3, 4, 4, 0.01, 0.02, 1e-4, 1e-4, 0.01])
    return CalibratedCamera(Camera(1920, 1080, INTRINSICS), root.T @ root, "client")


@given(factor=st.sampled_from([1 / 3, 0.5, 2.0, 2.1]))
@settings(deadline=None)
def test_scaling_moves_pixels_as_resampling_does(factor: float) -> None:
    camera = calibrated().camera
    (resized,) = cameras_for_photo(calibrated(), round(1920 * factor), round(1080 * factor))
    # Pixel centres at integers: u' + 1/2 = factor (u + 1/2).
    expected = (camera.project(POINTS_M) + 0.5) * factor - 0.5
    np.testing.assert_allclose(resized.camera.project(POINTS_M), expected, atol=1e-9)
    np.testing.assert_allclose(np.diag(resized.covariance)[:4], np.diag(calibrated().covariance)[:4] * factor**2)
    np.testing.assert_allclose(resized.covariance[4:, 4:], calibrated().covariance[4:, 4:])


def test_the_own_size_changes_nothing() -> None:
    camera = calibrated()
    assert scaled(camera, 1920, 1080) is camera


def test_a_transposed_photograph_has_both_quarter_turns() -> None:
    clockwise, anticlockwise = cameras_for_photo(calibrated(), 1080, 1920)
    u, v = calibrated().camera.project(POINTS_M).T
    x, y, z = POINTS_M.T
    turned_clockwise = clockwise.camera.project(np.column_stack([-y, x, z]))
    np.testing.assert_allclose(turned_clockwise, np.column_stack([1079 - v, u]), atol=1e-9)
    turned_back = anticlockwise.camera.project(np.column_stack([y, -x, z]))
    np.testing.assert_allclose(turned_back, np.column_stack([v, 1919 - u]), atol=1e-9)


@pytest.mark.parametrize("quarter_turns", [1, 3])
def test_covariance_turns_with_the_intrinsics(quarter_turns: int) -> None:
    camera = calibrated()
    root = np.linalg.cholesky(camera.covariance)
    draws = INTRINSICS + np.random.default_rng(0).normal(size=(20_000, 9)) @ root.T
    moved = np.array([camera.camera.with_intrinsics(d).turned(quarter_turns).intrinsics for d in draws])
    sigmas = np.sqrt(np.diag(turned(camera, quarter_turns).covariance))
    # Sigmas of 20,000 draws scatter by 0.5 %, correlations by 0.007: four times that.
    np.testing.assert_allclose(moved.std(axis=0), sigmas, rtol=0.02)
    expected = turned(camera, quarter_turns).covariance / np.outer(sigmas, sigmas)
    np.testing.assert_allclose(np.corrcoef(moved.T), expected, atol=0.03)


def test_turning_back_restores_camera_and_covariance() -> None:
    again = turned(turned(calibrated(), 1), 3)
    np.testing.assert_allclose(again.camera.intrinsics, INTRINSICS)
    np.testing.assert_allclose(again.covariance, calibrated().covariance, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("size", [(1440, 1080), (1080, 1440), (1000, 1000)])
def test_another_cut_of_the_sensor_is_an_unknown_camera(size: tuple[int, int]) -> None:
    with pytest.raises(NotLocated) as refusal:
        cameras_for_photo(calibrated(), *size)
    assert refusal.value.fields["reason"] == "unknown-camera"
