"""What a survey lacks, on a synthetic wall whose places are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.geometry.camera import CameraIdentity
from app.geometry.control import ControlPoint
from app.geometry.observations import Detection
from app.geometry.target_map import TargetMap
from app.photogrammetry.survey_guidance import Guidance, GuidedTarget, guide_survey
from app.photogrammetry.survey_input import PlateSpec, SurveyPhoto
from app.photogrammetry.viewpoints import Viewed, Viewpoints
from app.targets.layout import DEFAULT_U_M
from tests.photogrammetry.resection_scene import CAMERA, Scene, calibrated, is_in_view, looking, map_of, observe
from tests.photogrammetry.watched_scene import MOVED, wall

PLATE = PlateSpec("golay", DEFAULT_U_M)
IDENTITY = CameraIdentity("Maker", "Phone", CAMERA.width_px, CAMERA.height_px, 4.2, 26.0)
AIM_M = (3.9, 6.0, 1.4)
EYES_M = [(2.4, 2.6, 1.4), (3.4, 2.2, 1.6), (4.6, 2.3, 1.3), (5.6, 2.7, 1.5)]
SITE_ERROR_M = 0.1  # of a quick network that has not been adjusted with its control


@pytest.fixture
def plates() -> TargetMap:
    return wall(np.random.default_rng(5))


def taken(plates: TargetMap, eyes_m: Sequence[Sequence[float]], hidden: Sequence[int] = ()) -> list[SurveyPhoto]:
    rng, photos = np.random.default_rng(3), []
    for number, eye_m in enumerate(eyes_m):
        pose = looking(eye_m, AIM_M)
        seen = [target for target in plates.targets if is_in_view(target, pose) and target.code not in hidden]
        detection = Detection(
            CAMERA.width_px, CAMERA.height_px, tuple(observe(Scene(pose, map_of(seen), calibrated()), rng))
        )
        photos.append(SurveyPhoto(f"{number}.jpg", IDENTITY, detection))
    return photos


def without(photo: SurveyPhoto, *codes: int) -> SurveyPhoto:
    kept = tuple(target for target in photo.detection.targets if target.code not in codes)
    return replace(photo, detection=replace(photo.detection, targets=kept))


def control(plates: TargetMap, codes: Sequence[int]) -> list[ControlPoint]:
    return [
        ControlPoint(f"P{code}", code, "centre", plates.by_code[code].site_from_target.position_m, 0.001, "control")
        for code in codes
    ]


def guided(guidance: Guidance, code: int) -> GuidedTarget:
    (target,) = (target for target in guidance.targets if target.code == code)
    return target


def test_nothing_yet_is_no_error() -> None:
    guidance = guide_survey([], [], PLATE)
    assert (guidance.targets, guidance.frame, guidance.next_shot) == ((), "none", None)
    assert guidance.trouble


def test_one_photograph_counts_rays_and_names_companions(plates: TargetMap) -> None:
    guidance = guide_survey(taken(plates, EYES_M[:1]), [], PLATE)
    assert guidance.frame == "none"
    assert {target.state for target in guidance.targets} == {"few-rays"}
    assert all(target.rays == 1 and target.shot is None and len(target.companions) == 3 for target in guidance.targets)


def test_four_well_placed_photographs_lack_nothing(plates: TargetMap) -> None:
    guidance = guide_survey(taken(plates, EYES_M), [], PLATE)
    assert (guidance.photographs, guidance.oriented, guidance.loose) == (4, 4, ())
    assert (guidance.lacking, guidance.next_shot, guidance.frame) == ((), None, "model")
    assert all(target.angle_rad is not None and target.angle_rad > 0.5 for target in guidance.targets)


def test_a_target_seen_twice_needs_a_third_ray(plates: TargetMap) -> None:
    first, second, *others = taken(plates, EYES_M)
    photos = [first, second, *(without(photo, MOVED) for photo in others)]
    guidance = guide_survey(photos, control(plates, (1, 4, 9, 12)), PLATE)
    (target,) = guidance.lacking
    assert (target.code, target.state, target.rays, guidance.frame) == (MOVED, "few-rays", 2, "site")
    assert guidance.next_shot is not None and guidance.next_shot.codes == (MOVED,)
    assert target.shot is not None
    centre_m = plates.by_code[MOVED].site_from_target.position_m
    np.testing.assert_allclose(target.shot.aim_m, centre_m, atol=SITE_ERROR_M)
    rays = np.array(EYES_M[:2]) - centre_m
    new = target.shot.eye_m - centre_m
    cosines = rays @ new / np.linalg.norm(rays, axis=1) / np.linalg.norm(new)
    assert np.degrees(np.arccos(cosines)).min() > 10.0
    assert np.linalg.norm(np.array(EYES_M) - target.shot.eye_m, axis=1).min() < 1.0, "near to where one can stand"


def test_photographs_from_one_place_meet_too_narrowly(plates: TargetMap) -> None:
    eyes_m = [(3.9 + 0.05 * number, 2.4, 1.4) for number in range(3)]
    guidance = guide_survey(taken(plates, eyes_m), [], PLATE)
    assert {target.state for target in guidance.targets} == {"narrow"}
    assert guidance.next_shot is not None and len(guidance.next_shot.codes) > 3


def test_a_photograph_that_shares_nothing_is_loose(plates: TargetMap) -> None:
    *others, last = taken(plates, EYES_M)
    alone = replace(without(last, *range(2, 20)), name="alone.jpg")
    photos = [*(without(photo, 1) for photo in others), alone]
    guidance = guide_survey(photos, [], PLATE)
    assert guidance.loose == ("alone.jpg",)
    assert guided(guidance, 1).shot is None


def test_a_control_point_that_no_photograph_shows_is_missed(plates: TargetMap) -> None:
    photos = [without(photo, 4) for photo in taken(plates, EYES_M)]
    target = guided(guide_survey(photos, control(plates, (1, 4, 9, 12)), PLATE), 4)
    assert (target.state, target.rays, target.control) == ("unseen", 0, True)


def test_right_is_right_for_whoever_faces_the_plate(plates: TargetMap) -> None:
    pose = plates.by_code[MOVED].site_from_target
    stations_m = (pose.position_m + np.array([0.0, -3.0, 0.0]))[None]
    viewed = Viewed(pose.rotation, pose.position_m, stations_m, ("a.jpg",))
    shot = Viewpoints(True, stations_m, ("a.jpg",)).shot(viewed)
    # The plate looks along -y: whoever faces it looks along +y and has +x to the right.
    assert shot.right_m == pytest.approx(shot.eye_m[0] - stations_m[0, 0])
    assert shot.back_m == pytest.approx(stations_m[0, 1] - shot.eye_m[1])
    assert abs(shot.up_m) < 1e-9
