"""Priors of cameras: where their centre stands, how wide they are, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity
from app.photogrammetry.camera_prior import (
    FILM_DIAGONAL_MM,
    FILM_WIDTH_MM,
    CameraPriorOptions,
    camera_from_client,
    camera_from_exif,
    camera_of_model,
)

sizes = st.sampled_from([(1920, 1080), (1280, 720), (4000, 3000), (3000, 4000), (4000, 2250), (3024, 4032)])


def identity(width_px: int, height_px: int, focal_35mm: float | None) -> CameraIdentity:
    return CameraIdentity("Maker", "Phone", width_px, height_px, focal_35mm=focal_35mm)


def phone(sigma: float) -> CalibratedCamera:
    intrinsics = np.array([1400.0, 1401.0, 960.0, 540.0, 0.1, -0.2, 0.0, 0.0, 0.05])
    return CalibratedCamera(Camera(1920, 1080, intrinsics), np.eye(9) * sigma**2, "survey")


@given(size=sizes, focal_35mm=st.integers(20, 120))
@settings(deadline=None)
def test_exif_prior_covers_both_conventions_within_its_sigma_and_a_half(size: tuple[int, int], focal_35mm: int) -> None:
    calibrated = camera_from_exif(identity(*size, focal_35mm))
    focal_px, sigma_px = calibrated.camera.fx_px, np.sqrt(calibrated.covariance[0, 0])
    by_width_px = focal_35mm * max(size) / FILM_WIDTH_MM
    by_diagonal_px = focal_35mm * float(np.hypot(*size)) / FILM_DIAGONAL_MM
    assert abs(by_width_px / by_diagonal_px - 1.0) > 0.03  # the two are really apart
    assert max(abs(by_width_px - focal_px), abs(by_diagonal_px - focal_px)) < 1.5 * sigma_px
    assert sigma_px < 0.05 * focal_px
    assert calibrated.source == "exif"


@given(size=sizes)
@settings(deadline=None)
def test_exif_prior_is_centred_square_and_positive_definite(size: tuple[int, int]) -> None:
    calibrated = camera_from_exif(identity(*size, 27.0))
    fx, fy, cx, cy, *distortion = calibrated.camera.intrinsics
    assert fx == fy
    assert (cx, cy) == ((size[0] - 1) / 2.0, (size[1] - 1) / 2.0)
    assert distortion == [0.0] * 5
    assert np.linalg.eigvalsh(calibrated.covariance).min() > 0
    ratio_step = np.array([1.0 / fx, -1.0 / fy, *[0.0] * 7])  # fx and fy move together
    assert np.sqrt(ratio_step @ calibrated.covariance @ ratio_step) == pytest.approx(CameraPriorOptions().aspect)


@pytest.mark.parametrize("focal_35mm", [None, 0.0, 3.0, 1e6, float("nan")])
def test_exif_without_believable_focal_is_an_unknown_camera(focal_35mm: float | None) -> None:
    with pytest.raises(NotLocated) as refusal:
        camera_from_exif(identity(1920, 1080, focal_35mm))
    assert refusal.value.fields["reason"] == "unknown-camera"
    assert "calibrate" in refusal.value.fields["advice"]


def test_client_covariance_is_taken_as_given_and_missing_ones_are_documented_sigmas() -> None:
    camera, options = phone(1.0).camera, CameraPriorOptions()
    given_covariance = np.diag(np.arange(1.0, 10.0))
    assert camera_from_client(camera, given_covariance).covariance is given_covariance
    sigmas = np.sqrt(np.diag(camera_from_client(camera).covariance))
    assert sigmas[0] == pytest.approx(options.client_focal * 1400.0, rel=0.01)
    assert sigmas[2] == pytest.approx(options.client_centre * 1920)
    np.testing.assert_allclose(sigmas[4:], options.client_distortion)


def test_missing_distortion_is_not_zero_distortion() -> None:
    camera, options = phone(1.0).camera, CameraPriorOptions()
    sigmas = np.sqrt(np.diag(camera_from_client(camera, distortion_known=False).covariance))
    np.testing.assert_allclose(sigmas[4:], options.unknown_distortion)


def test_another_unit_of_the_model_has_at_least_half_a_percent_of_focal_sigma() -> None:
    other = camera_of_model(phone(1e-3))
    assert np.sqrt(other.covariance[0, 0]) / other.camera.fx_px >= 0.005
    assert other.source == "model"
    np.testing.assert_array_equal(other.camera.intrinsics, phone(1e-3).camera.intrinsics)
    assert np.linalg.eigvalsh(other.covariance - phone(1e-3).covariance).min() > 0
