from dataclasses import replace

import cv2
import numpy as np
import pytest

from app.planning.survey_plan import SurveyPlan, small_room
from app.planning.synthetic import render
from app.targets.digits import digits_of_code
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.photo import load_photo, read_header


@pytest.fixture(scope="module")
def plan() -> SurveyPlan:
    return small_room(family_by_name("golay"), seed=1)


def test_a_photograph_is_that_of_its_seed(plan: SurveyPlan) -> None:
    arguments = (plan.scene, plan.camera, plan.stations[0], plan.imaging)
    first = render(*arguments, 1)
    assert render(*arguments, 1).jpeg == first.jpeg
    assert render(*arguments, 2).jpeg != first.jpeg


def test_the_file_says_which_camera_took_it_and_when(plan: SurveyPlan) -> None:
    photo = plan.photograph(3)
    header = read_header(photo.jpeg)
    assert header.identity == photo.identity
    assert (header.width_px, header.height_px) == (640, 480)
    assert header.captured_at == "2026:01:01 12:00:03"
    assert header.identity.focal_35mm == pytest.approx(plan.camera.fx_px / 640 * 36, abs=0.5)


def test_a_file_may_say_nothing(plan: SurveyPlan) -> None:
    silent = replace(plan, imaging=replace(plan.imaging, write_exif=False)).photograph(0)
    assert not read_header(silent.jpeg).has_exif


def test_chroma_is_stored_at_half_the_resolution(plan: SurveyPlan) -> None:
    jpeg = plan.photograph(0).jpeg
    frame = jpeg.index(b"\xff\xc0")  # start of frame: length, precision, height, width, components, then each one
    assert jpeg[frame + 11] == 0x22 and jpeg[frame + 14] == 0x11  # sampling factors of luma and of the first chroma


def test_colours_stand_at_the_true_dots(plan: SurveyPlan) -> None:
    photo = plan.photograph(0)
    bgr = load_photo(photo.jpeg).bgr.astype(int)
    whole = [target for target in photo.targets if target.whole]
    assert whole
    for target in whole:
        digits = dict(zip(DIGIT_CELLS, digits_of_code(target.code).tolist(), strict=True))
        for cell, (x_px, y_px) in enumerate(target.dots_px):
            blue, green, red = bgr[round(y_px), round(x_px)]
            if cell in BASE_CELLS:
                assert red > green + 20 and red > blue + 20
            elif digits[cell] == 2:
                assert min(blue, green, red) > 80
            elif digits[cell] == 1:
                assert green > red + 10
            else:
                assert max(blue, green, red) < 80


def test_blur_noise_and_darkness_are_seen_in_the_pixels(plan: SurveyPlan) -> None:
    def sharpness_and_level(**changes: object) -> tuple[float, float]:
        imaging = replace(plan.imaging, full_well_electrons=0.0, **changes)  # type: ignore[arg-type]
        jpeg = render(plan.scene, plan.camera, plan.stations[0], imaging, 0).jpeg
        grey = cv2.imdecode(np.frombuffer(jpeg, dtype=np.uint8), cv2.IMREAD_GRAYSCALE).astype(float)
        return float(cv2.Laplacian(grey, cv2.CV_64F).std()), float(grey.mean())

    sharp, level = sharpness_and_level()
    assert sharpness_and_level(defocus_radius_px=2.0)[0] < 0.6 * sharp
    assert sharpness_and_level(motion_px=(6.0, 2.0))[0] < 0.8 * sharp
    assert sharpness_and_level(exposure_ev=-2.0)[1] < 0.6 * level
