"""Cameras of a survey: posterior, and the scatter of focal lengths and principal points between photographs."""

from __future__ import annotations

import numpy as np

from app.photogrammetry.self_calibration import self_calibrate
from app.photogrammetry.survey import SurveyPhoto, adjust_survey
from tests.photogrammetry.survey_scene import (
    CAMERA,
    CONTROL_DOTS,
    IDENTITY,
    PLATE,
    build_room,
    control_points,
    photograph,
    ring_of_stations,
    survey_photos,
)
from tests.photogrammetry.true_network import see

ROOM = build_room(12)
STATIONS = ring_of_stations(24)


def test_the_posterior_covers_the_truth() -> None:
    result = adjust_survey(survey_photos(ROOM, STATIONS), control_points(ROOM, CONTROL_DOTS), PLATE)
    calibrated = result.cameras[0].calibrated
    off = calibrated.camera.intrinsics - CAMERA.intrinsics
    assert off @ np.linalg.solve(calibrated.covariance, off) < 27.9  # 99.9 % of chi-square with nine degrees
    assert calibrated.source == "survey"


def test_scatter_between_photographs_is_found() -> None:
    """Autofocus moves each photograph's focal length by 0.3 %, stabilisation its principal point by 4 px."""
    rng = np.random.default_rng(21)
    photos = []
    for number, station in enumerate(STATIONS):
        own = CAMERA.intrinsics.copy()
        own[:2] *= 1.0 + 0.003 * rng.normal()
        own[2:4] += 4.0 * rng.normal(size=2)
        detection = photograph(ROOM, station, rng, CAMERA.with_intrinsics(own))
        photos.append(SurveyPhoto(f"photo{number:02d}.jpg", IDENTITY, detection))
    record = adjust_survey(photos, control_points(ROOM, CONTROL_DOTS), PLATE).report.cameras[0]
    # Twenty-four photographs give a standard deviation to 15 %; targets that are free to follow their photographs take
    # up to half of it: the order of magnitude is what a prior needs.
    assert 0.3 * 0.003 < record.focal_scatter < 1.6 * 0.003
    assert (record.centre_scatter_px > 0.3 * 4.0).all()
    assert (record.centre_scatter_px < 1.6 * 4.0).all()


def test_without_scatter_there_is_next_to_none() -> None:
    truth = see(ROOM, STATIONS, noise_px=0.1)
    (camera,) = self_calibrate(truth.problem, truth.network, np.eye(9))
    assert camera.photographs == len(STATIONS)
    assert camera.scatter.focal < 0.001
    assert (camera.scatter.centre_px < 1.0).all()


def test_two_photographs_tell_no_scatter() -> None:
    truth = see(ROOM, STATIONS[:2], noise_px=0.1)
    (camera,) = self_calibrate(truth.problem, truth.network, np.eye(9))
    assert camera.scatter.focal == 0.0
    np.testing.assert_array_equal(camera.calibrated.covariance, np.eye(9))
