"""A camera calibrated in a mapped room: honest, robust, and refused where the photographs do not carry it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from app.errors import CalibrationFailed
from app.geometry.camera import INTRINSIC_COUNT
from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap
from app.photogrammetry.calibration.calibrate import Calibration, calibrate_camera
from app.photogrammetry.survey import SurveyPhoto
from tests.photogrammetry.calibration.scene import ROOM, shots, stations, surveyed_map, zoomed
from tests.photogrammetry.survey_scene import CAMERA, IDENTITY, OTHER_CAMERA, OTHER_IDENTITY, looking

SURE = 5.0  # standard deviations that no honest estimate is off
TRIALS = 6


def focal_sigmas(calibration: Calibration) -> float:
    calibrated = calibration.calibrated
    return float((calibrated.camera.fx_px - CAMERA.fx_px) / np.sqrt(calibrated.covariance[0, 0]))


def refusal(photos: list[SurveyPhoto], target_map: TargetMap | None = None) -> CalibrationFailed:
    with pytest.raises(CalibrationFailed) as failed:
        calibrate_camera(photos, target_map or surveyed_map())
    return failed.value


def test_intrinsics_err_as_their_covariance_says() -> None:
    squares = []
    for seed in range(TRIALS):
        found = calibrate_camera(shots(stations(9, seed), seed=100 * seed), surveyed_map(seed))
        error = found.calibrated.camera.intrinsics - CAMERA.intrinsics
        squares.append(float(error @ np.linalg.solve(found.calibrated.covariance, error)))
        assert found.calibrated.source == "calibration"
        assert found.left_out == ()
    # The sum of squares is chi-square with nine per trial; a fifth more for what of the map's errors is not modelled.
    low, high = chi2.ppf([1e-4, 1 - 1e-4], TRIALS * INTRINSIC_COUNT)
    assert low / 2.0 < sum(squares) < 1.2 * high


def test_a_camera_without_exif_is_found_on_the_ladder() -> None:
    nameless = replace(IDENTITY, make="", model="", focal_mm=None, focal_35mm=None)
    found = calibrate_camera(shots(stations(8), identity_of=lambda _: nameless), surveyed_map())
    assert abs(focal_sigmas(found)) < SURE


def test_photographs_of_another_camera_and_of_another_zoom_are_named_and_left_out() -> None:
    photos = shots(
        stations(12),
        camera_of=lambda index: OTHER_CAMERA if index == 2 else zoomed(1.15) if index == 4 else CAMERA,
        identity_of=lambda index: OTHER_IDENTITY if index == 2 else IDENTITY,
    )
    found = calibrate_camera(photos, surveyed_map())
    assert {photo.name: photo.reason for photo in found.left_out} == {
        "photo2.jpg": "other-camera",
        "photo4.jpg": "other-zoom",
    }
    assert abs(focal_sigmas(found)) < SURE


def test_targets_that_were_moved_are_named_and_take_no_part() -> None:
    moved = ROOM
    for code in (105, 113):
        pose = ROOM.poses[code]
        moved = moved.with_pose(code, Pose(pose.rotation, pose.position_m + np.array([0.01, 0.0, 0.01])))
    found = calibrate_camera(shots(stations(12), room=moved), surveyed_map())
    assert {target.code for target in found.refused_targets if target.left_out} == {105, 113}
    assert abs(focal_sigmas(found)) < SURE


@pytest.mark.parametrize("breathing", [0.003, 0.01])
def test_breathing_is_estimated_and_stands_in_the_covariance(breathing: float) -> None:
    factors = 1.0 + breathing * np.random.default_rng(7).normal(size=15)
    found = calibrate_camera(shots(stations(15), camera_of=lambda index: zoomed(factors[index])), surveyed_map())
    # Of 15 values a standard deviation is known to a fifth; three of these.
    assert found.scatter.focal == pytest.approx(np.std(factors, ddof=1), rel=0.6)
    assert np.sqrt(found.calibrated.covariance[0, 0]) / CAMERA.fx_px >= found.scatter.focal
    assert abs(focal_sigmas(found)) < SURE


def test_views_from_the_front_carry_no_focal_length() -> None:
    target_map = surveyed_map()
    code = 120
    wall = replace(target_map, targets=(target_map.by_code[code],))
    middle_m = ROOM.poses[code].position_m
    normal = ROOM.poses[code].rotation[:, 2]
    places = [looking(middle_m + (0.6 + 0.05 * step) * normal, -normal, 0.1) for step in range(8)]
    failed = refusal(shots(places), wall)
    assert failed.fields["reason"] in ("focal-not-carried", "too-few-photos")
    assert "near and far" in failed.detail


def test_too_few_photographs_and_none_with_targets_are_refused() -> None:
    assert refusal(shots(stations(4))).fields["reason"] == "too-few-photos"
    other_site = replace(
        surveyed_map(), targets=tuple(replace(target, code=target.code + 1000) for target in surveyed_map().targets)
    )
    assert refusal(shots(stations(6)), other_site).fields["reason"] == "no-targets"


def test_photographs_of_many_cameras_are_refused() -> None:
    photos = shots(stations(6), identity_of=lambda index: replace(IDENTITY, model=f"Phone {index}"))
    assert refusal(photos).fields["reason"] == "several-cameras"
