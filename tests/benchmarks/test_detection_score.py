"""Detection scores on detections that are made up."""

from __future__ import annotations

import numpy as np
import pytest

from app.cli.room import PlateInView, TrueShot, TrueShots
from app.geometry.camera import Camera, CameraIdentity
from app.geometry.observations import Detection, TargetObservation
from app.geometry.pose import Pose
from app.photogrammetry.survey import SurveyPhoto
from app.targets.layout import dots_target_m
from benchmarks.coverage_score import score_coverage
from benchmarks.detection_score import DetectionScore, dot_rmse_px, score_detections, score_to_json
from tests.benchmarks.test_map_score import map_of

U_M, FOCAL_PX, DISTANCE_M = 0.014, 1000.0, 2.0
CAMERA = Camera(1280, 720, np.array([FOCAL_PX, FOCAL_PX, 640.0, 360.0, 0, 0, 0, 0, 0.0]))
FACING = np.diag([1.0, -1.0, -1.0])  # a camera at the origin looks along the site's -z: the plates face it
SITE_FROM_CAM = Pose(FACING, np.array([0.0, 0.0, DISTANCE_M]))
PLACES_M = {10: np.array([-0.5, 0.0, 0.0]), 20: np.array([0.5, 0.0, 0.0])}
DOTS_M = {code: dots_target_m(U_M) + place_m for code, place_m in PLACES_M.items()}
SIZE_PX_PER_U = FOCAL_PX * U_M / DISTANCE_M
SIGMA_PX = 0.05


def seen_px(code: int) -> np.ndarray:
    return CAMERA.project(SITE_FROM_CAM.inverse().apply(DOTS_M[code]))


def observed(code: int, centres_px: np.ndarray) -> TargetObservation:
    covariances = np.tile(np.eye(2) * SIGMA_PX**2, (16, 1, 1))
    return TargetObservation(code, centres_px, covariances, np.ones(16, dtype=np.bool_))


def scored(*targets: TargetObservation, wrong_plate: bool = False) -> DetectionScore:
    plates = [PlateInView(code, SIZE_PX_PER_U, 20.0, seen_px(code)) for code in DOTS_M]
    if wrong_plate:
        plates.append(PlateInView(None, SIZE_PX_PER_U, 20.0, seen_px(10) + 200.0))
    truth = TrueShots(CAMERA, {"a.jpg": TrueShot("a.jpg", SITE_FROM_CAM, tuple(plates))})
    photo = SurveyPhoto("a.jpg", CameraIdentity("", "", 1280, 720), Detection(1280, 720, targets))
    return score_detections([photo], truth, DOTS_M)


def test_what_is_right_and_what_is_missing() -> None:
    score = scored(observed(10, seen_px(10)))
    assert (score.counted_found, score.counted_total, score.wrong_codes) == (1, 2, 0)
    assert (score.found.sum(), score.total.sum()) == (1, 2)
    assert dot_rmse_px(score) == pytest.approx(0.0, abs=1e-9)


def test_a_code_in_another_place_is_wrong() -> None:
    score = scored(observed(10, seen_px(20)), observed(20, seen_px(20) + 3.0 * SIZE_PX_PER_U))
    assert (score.counted_found, score.wrong_codes) == (0, 2)


def test_a_code_that_does_not_exist_is_wrong() -> None:
    assert scored(observed(30, seen_px(10))).wrong_codes == 1


def test_a_plate_of_wrong_structure_must_not_be_read() -> None:
    assert scored(wrong_plate=True).wrong_plates_read == 0
    score = scored(observed(10, seen_px(10) + 200.0), wrong_plate=True)
    assert (score.wrong_plates_read, score.wrong_plates, score.wrong_codes) == (1, 1, 1)


def test_dot_errors_and_their_normalised_square() -> None:
    rng = np.random.default_rng(1)
    noise_px = rng.normal(scale=SIGMA_PX, size=(2, 16, 2))
    score = scored(observed(10, seen_px(10) + noise_px[0]), observed(20, seen_px(20) + noise_px[1]))
    assert dot_rmse_px(score) == pytest.approx(np.sqrt(np.square(noise_px).mean()))
    assert score.nees.mean() == pytest.approx(2.0 * np.square(noise_px / SIGMA_PX).mean())
    assert dot_rmse_px(score, least=SIZE_PX_PER_U + 0.1) is None


def test_nothing_found_has_a_record_too() -> None:
    record = score_to_json(scored())
    assert record["recall"] == 0.0
    assert record["dot_rmse_px"] is None


def test_coverage_asks_for_three_rays_and_five_degrees() -> None:
    shots, photos = {}, []
    for step in range(3):
        name = f"{step}.jpg"
        pose = Pose(FACING, np.array([0.2 * step, 0.0, DISTANCE_M]))  # 11 degrees from the first to the last
        shots[name] = TrueShot(name, pose, ())
        codes = (10, 20) if step < 2 else (10,)
        targets = tuple(observed(code, seen_px(code)) for code in codes)
        photos.append(SurveyPhoto(name, CameraIdentity("", "", 1280, 720), Detection(1280, 720, targets)))
    truth = TrueShots(CAMERA, shots)
    identity = Pose(np.eye(3), np.zeros(3))
    score = score_coverage(map_of({20: identity, 99: identity}), photos, truth, DOTS_M)
    assert (score.carried, score.missing, score.wrong_codes) == (1, (10,), (99,))
