"""Centre errors on the dots that several detectors measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.cli.room import PlateInView, TrueShot, TrueShots
from app.geometry.camera import CameraIdentity
from app.geometry.observations import Detection, TargetObservation
from app.photogrammetry.survey import SurveyPhoto
from app.targets.layout import BASE_CELLS
from benchmarks.shared_dots import shared_dot_errors
from tests.benchmarks.test_detection_score import CAMERA, DOTS_M, SITE_FROM_CAM, SIZE_PX_PER_U, observed, seen_px

PLATES = tuple(PlateInView(code, SIZE_PX_PER_U, 20.0, seen_px(code)) for code in DOTS_M)
TRUTH = TrueShots(CAMERA, {"a.jpg": TrueShot("a.jpg", SITE_FROM_CAM, PLATES)})


def reading(*targets: TargetObservation) -> list[SurveyPhoto]:
    return [SurveyPhoto("a.jpg", CameraIdentity("", "", 1280, 720), Detection(1280, 720, targets))]


def test_only_what_all_have_read_in_its_place_counts() -> None:
    exact, off_px = observed(10, seen_px(10)), np.array([0.1, 0.0])
    both = reading(exact, observed(20, seen_px(20) + 50.0))  # 20 was misread elsewhere
    other = reading(observed(10, seen_px(10) + off_px), observed(20, seen_px(20)))
    errors_px, other_errors_px = shared_dot_errors([both, other], TRUTH)
    np.testing.assert_allclose(errors_px, np.zeros((len(BASE_CELLS), 2)))
    np.testing.assert_allclose(other_errors_px, np.tile(off_px, (len(BASE_CELLS), 1)))


def test_only_dots_that_all_have_measured_count() -> None:
    measured = np.ones(16, dtype=np.bool_)
    measured[BASE_CELLS[0]] = False
    partly = replace(observed(10, seen_px(10)), measured=measured)
    for errors_px in shared_dot_errors([reading(partly), reading(observed(10, seen_px(10)))], TRUTH):
        assert len(errors_px) == len(BASE_CELLS) - 1


def test_nothing_in_common_is_no_error() -> None:
    apart = [reading(observed(10, seen_px(10))), reading(observed(20, seen_px(20)))]
    assert [errors_px.shape for errors_px in shared_dot_errors(apart, TRUTH)] == [(0, 2), (0, 2)]
