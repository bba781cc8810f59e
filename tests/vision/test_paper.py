from dataclasses import replace

import numpy as np
import pytest

from app.geometry.observations import Detection
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.survey_plan import SurveyPlan, look_at, phone_camera, small_room
from app.planning.synthetic import RenderedPhoto, render
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS, DOT_COUNT
from app.vision.paper import ColourOptions, PaperOptions, detect_paper, read_digits
from app.vision.photo import load_photo

GOLAY = family_by_name("golay")
INCIDENCE_MAX_DEG = 50.0  # the paper's rule of sizes, major at most twice the minor axis, ends near 60


@pytest.fixture(scope="module")
def plan() -> SurveyPlan:
    return small_room(GOLAY, seed=2)


@pytest.fixture(scope="module")
def photos(plan: SurveyPlan) -> list[tuple[RenderedPhoto, Detection]]:
    rendered = [plan.photograph(index) for index in (0, 3, 6, 9)]
    return [(photo, detect_paper(load_photo(photo.jpeg).bgr, GOLAY)) for photo in rendered]


def test_targets_seen_well_are_read_and_nothing_else_is(photos: list[tuple[RenderedPhoto, Detection]]) -> None:
    expected = read = 0
    for photo, detection in photos:
        codes = {target.code for target in detection.targets}
        assert codes <= {target.code for target in photo.targets}
        well = {t.code for t in photo.targets if t.whole and t.incidence_deg <= INCIDENCE_MAX_DEG}
        expected, read = expected + len(well), read + len(well & codes)
    # Measured over four rooms: 97 %. The rest fails on the fixed thresholds of the colour rule.
    assert expected >= 12 and read >= 0.85 * expected


def test_base_dots_are_measured_as_well_as_they_say(photos: list[tuple[RenderedPhoto, Detection]]) -> None:
    measured_px, predicted_px = [], []
    for photo, detection in photos:
        truth = {target.code: target.dots_px for target in photo.targets}
        for target in detection.targets:
            assert np.flatnonzero(target.measured).tolist() == sorted(BASE_CELLS)
            error_px = target.centres_px - truth[target.code]
            measured_px.append(error_px[target.measured])
            predicted_px.append(error_px[~target.measured])
    measured_rms_px, predicted_rms_px = (
        float(np.sqrt(np.mean(np.concatenate(errors) ** 2))) for errors in (measured_px, predicted_px)
    )
    assert 0.5 < measured_rms_px / PaperOptions().sigma_px < 1.5
    # Predicted dots lie between the base dots and take over their errors, amplified by at most two.
    assert predicted_rms_px < 2.0 * measured_rms_px


def test_plates_of_wrong_structure_are_refused() -> None:
    room = RoomOptions((2.6, 2.6, 2.4), targets=0, wrong_targets=5, u_m=0.02, walls=(0,), furniture=False)
    scene = build_room(room, GOLAY, seed=4)
    eye = look_at(np.array([1.3, 2.4, 1.3]), np.array([1.3, 0.0, 1.3]))
    photo = render(scene, phone_camera(640, 480), eye, small_room(GOLAY).imaging, seed=1)
    assert sum(target.wrong and target.whole for target in photo.targets) >= 3
    detection = detect_paper(load_photo(photo.jpeg).bgr, GOLAY)
    assert detection.targets == ()
    assert {rejected.reason for rejected in detection.rejected} == {"not-a-target"}


def test_a_plate_posted_twice_is_reported_and_kept_once(plan: SurveyPlan) -> None:
    code = plan.scene.targets[0].code
    twins = tuple(replace(target, code=code) for target in plan.scene.targets)
    scene = replace(plan.scene, targets=twins)
    photo = render(scene, plan.camera, plan.stations[0], plan.imaging, seed=1)
    detection = detect_paper(load_photo(photo.jpeg).bgr, GOLAY)
    assert [target.code for target in detection.targets] == [code]
    assert "duplicate-code" in {rejected.reason for rejected in detection.rejected}


def test_a_code_of_another_family_is_refused(plan: SurveyPlan) -> None:
    outsider = next(code for code in range(100_000, 200_000) if not GOLAY.contains(code))
    scene = replace(plan.scene, targets=(replace(plan.scene.targets[0], code=outsider),))
    station = next(pose for pose in plan.stations if render(scene, plan.camera, pose, plan.imaging, 1).whole_codes())
    bgr = load_photo(render(scene, plan.camera, station, plan.imaging, 1).jpeg).bgr
    assert [target.code for target in detect_paper(bgr, family_by_name("full")).targets] == [outsider]
    refused = detect_paper(bgr, GOLAY)
    assert refused.targets == () and [one.reason for one in refused.rejected] == ["code-not-in-family"]


@pytest.mark.parametrize(
    ("bgr", "digit"),
    [
        ((0, 49, 49), 0),
        ((0, 50, 0), -1),
        ((40, 150, 30), 1),
        ((40, 99, 30), -1),
        ((120, 160, 30), -1),
        ((160, 200, 170), 2),
        ((151, 255, 210), -1),
        ((255, 255, 255), 2),
        ((30, 30, 200), -1),
    ],
)
def test_the_colour_rule_is_the_papers(bgr: tuple[int, int, int], digit: int) -> None:
    assert read_digits(np.array([bgr], dtype=np.float64), ColourOptions()).tolist() == [digit]


@pytest.mark.parametrize("shape", [(1, 1, 3), (5, 400, 3), (64, 64, 3)])
def test_pictures_without_targets_give_none(shape: tuple[int, int, int]) -> None:
    for picture in (np.zeros(shape, np.uint8), np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)):
        detection = detect_paper(picture, GOLAY)
        assert detection.targets == () and (detection.width_px, detection.height_px) == (shape[1], shape[0])


def test_observations_have_a_covariance_for_every_dot(photos: list[tuple[RenderedPhoto, Detection]]) -> None:
    target = photos[0][1].targets[0]
    assert target.covariances_px2.shape == (DOT_COUNT, 2, 2)
    assert (np.linalg.eigvalsh(target.covariances_px2) > 0).all()
    assert target.corrected == target.erased == 0
