"""The survey as its callers see it: what comes out of good photographs, and what is said of bad ones."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from app.errors import Cancelled, SurveyFailed
from app.geometry.camera import CameraIdentity
from app.geometry.observations import Detection
from app.geometry.rotation import angle_between_deg
from app.photogrammetry.survey import SurveyPhoto, SurveyResult, adjust_survey
from tests.photogrammetry.survey_scene import (
    CAMERA,
    CHECK_DOTS,
    CONTROL_DOTS,
    IDENTITY,
    OTHER_CAMERA,
    OTHER_IDENTITY,
    PLATE,
    U_M,
    Room,
    build_room,
    control_points,
    dot_errors_m,
    ring_of_stations,
    survey_photos,
)

ROOM = build_room()
STATIONS = ring_of_stations(16)
CONTROL = control_points(ROOM, CONTROL_DOTS)


@pytest.fixture(scope="module")
def good() -> SurveyResult:
    """Photographs of 0.1 px, control of 1 mm, check points."""
    points = control_points(ROOM, CONTROL_DOTS, noise_m=0.001)
    points += control_points(ROOM, CHECK_DOTS, noise_m=0.001, role="check", seed=5)
    return adjust_survey(survey_photos(ROOM, STATIONS), points, PLATE)


def test_exact_photographs_and_control_give_the_truth() -> None:
    photos = survey_photos(ROOM, STATIONS, noise_px=0.0)
    result = adjust_survey(photos, CONTROL, PLATE)
    # Adjustments end when a step would lower the squares by less than 1e-6 of a variance, a thousandth of a sigma of a
    # millimetre; exact dots are given sigmas of 0.01 px, and held to a tenth of that.
    assert np.abs(dot_errors_m(ROOM, result.target_map.targets)).max() < 1e-6
    np.testing.assert_allclose(result.cameras[0].calibrated.camera.intrinsics[:4], CAMERA.intrinsics[:4], atol=1e-4)
    np.testing.assert_allclose(result.cameras[0].calibrated.camera.intrinsics[4:], CAMERA.intrinsics[4:], atol=1e-5)
    assert [photo.name for photo in result.photos] == [photo.name for photo in photos]
    for photo, station in zip(result.photos, STATIONS, strict=True):
        assert np.abs(photo.site_from_cam.position_m - station.position_m).max() < 1e-6
        assert angle_between_deg(photo.site_from_cam.rotation, station.rotation) < 1e-4


def test_photographs_name_the_targets_that_took_part(good: SurveyResult) -> None:
    for target in good.target_map.targets:
        assert target.rays == sum(target.code in photo.codes for photo in good.photos)
    assert [photo.targets for photo in good.report.photos] == [len(photo.codes) for photo in good.photos]


def test_a_good_survey_is_as_good_as_it_says(good: SurveyResult) -> None:
    assert len(good.photos) == len(STATIONS)
    datum = good.target_map.datum
    errors = []
    for target in good.target_map.targets:
        error_m = target.site_from_target.position_m - ROOM.poses[target.code].position_m
        covariance = target.covariance[:3, :3] + datum.pose_covariance(target.site_from_target.position_m)[:3, :3]
        errors.append(error_m @ np.linalg.solve(covariance, error_m))
    # Targets of one survey share its datum: their mean is that of a few independent chi-squares of 3, not of dozens.
    assert np.mean(errors) < 12.0
    assert 0.9 < good.report.sigma0 < 1.1  # its own deviation is 1 / sqrt(2 x 3000)


def test_check_points_judge_and_take_no_part(good: SurveyResult) -> None:
    points = control_points(ROOM, CONTROL_DOTS, noise_m=0.001)
    without = adjust_survey(survey_photos(ROOM, STATIONS), points, PLATE)
    for target, other in zip(good.target_map.targets, without.target_map.targets, strict=True):
        np.testing.assert_array_equal(target.dots_m, other.dots_m)
    assert without.report.check_rmse_m is None
    assert good.report.check_rmse_m is not None
    assert 0.0 < good.report.check_rmse_m < 0.008  # check noise of 1.7 mm, datum of 2 mm, targets of 1 mm


def test_the_report_is_json_and_complete(good: SurveyResult) -> None:
    record = json.loads(json.dumps(good.report.to_json()))
    assert len(record["photos"]) == len(STATIONS)
    assert {target["code"] for target in record["targets"]} == set(good.target_map.by_code)
    camera = record["cameras"][0]
    assert np.shape(camera["correlations"]) == (9, 9)
    np.testing.assert_allclose(np.diag(camera["correlations"]), 1.0)
    assert len(record["control"]) == len(CONTROL_DOTS) + len(CHECK_DOTS)
    assert record["redundancy"] > 0


def test_targets_seen_too_seldom_are_reported_and_not_published(good: SurveyResult) -> None:
    assert all(target.rays >= 3 for target in good.target_map.targets)
    left = {record.code: record.reason for record in good.report.left_out}
    seen = {target.code for photo in survey_photos(ROOM, STATIONS) for target in photo.detection.targets}
    assert set(left) | set(good.target_map.by_code) == seen
    assert set(left.values()) <= {"rays", "angle"}


def test_the_print_scale_is_found() -> None:
    room = build_room(scale_xy=(1.003, 0.998))
    result = adjust_survey(
        survey_photos(room, STATIONS, noise_px=0.0), control_points(room, CONTROL_DOTS, sigma_m=1e-5), PLATE
    )
    # Four points of 0.01 mm some metres apart, against a prior of 0.2 %.
    np.testing.assert_allclose(result.report.print_scale.scale, [1.003, 0.998], atol=2e-5)
    assert not result.report.print_scale.held
    assert np.abs(dot_errors_m(room, result.target_map.targets)).max() < 1e-4


def test_a_fitted_page_is_warned_of_and_its_map_is_right() -> None:
    room = build_room(scale_xy=(0.955, 0.955))
    result = adjust_survey(survey_photos(room, STATIONS), control_points(room, CONTROL_DOTS), PLATE)
    assert any("95.5 %" in warning for warning in result.report.warnings)
    assert np.abs(dot_errors_m(room, result.target_map.targets)).max() < 0.005


def test_without_control_scale_and_upright_are_assumed() -> None:
    result = adjust_survey(survey_photos(ROOM, STATIONS), (), PLATE)
    datum = result.target_map.datum
    assert datum.assumed_scale
    assert datum.assumed_orientation
    assert len(result.report.warnings) == 2
    centres_m = np.array([target.site_from_target.position_m for target in result.target_map.targets])
    true_m = np.array([ROOM.poses[target.code].position_m for target in result.target_map.targets])
    heights_m = true_m[:, 2] - true_m[:, 2].mean()
    # Plates lean by 0.05 rad, thirty of them: the upright axis is good to 0.01 rad, at most 4 m from the middle.
    assert np.abs(centres_m[:, 2] - heights_m).max() < 4.0 * 0.05 / np.sqrt(30) * 4.0
    spread = np.linalg.norm(centres_m - centres_m.mean(axis=0)) / np.linalg.norm(true_m - true_m.mean(axis=0))
    assert abs(spread - 1.0) < 4.0 * np.sqrt(datum.covariance[6, 6])


def test_two_cameras_are_calibrated_each() -> None:
    photos = survey_photos(ROOM, STATIONS, noise_px=0.0)
    others = survey_photos(
        ROOM, ring_of_stations(12, seed=9), noise_px=0.0, identity=OTHER_IDENTITY, camera=OTHER_CAMERA, first=50
    )
    mixed = [photo for pair in zip(photos, others, strict=False) for photo in pair] + photos[len(others) :]
    result = adjust_survey(mixed, CONTROL, PLATE)
    found = {camera.identity.key: camera.calibrated.camera for camera in result.cameras}
    assert set(found) == {IDENTITY.key, OTHER_IDENTITY.key}
    np.testing.assert_allclose(found[IDENTITY.key].intrinsics[:4], CAMERA.intrinsics[:4], atol=1e-3)
    np.testing.assert_allclose(found[OTHER_IDENTITY.key].intrinsics[:4], OTHER_CAMERA.intrinsics[:4], atol=1e-3)
    keys = {photo.name: photo.camera_key for photo in result.photos}
    assert all(keys[photo.name] == photo.identity.key for photo in mixed)


def failed(photos: list[SurveyPhoto], reason: str) -> SurveyFailed:
    with pytest.raises(SurveyFailed) as caught:
        adjust_survey(photos, (), PLATE)
    assert caught.value.fields["reason"] == reason
    return caught.value


def test_no_photograph_and_one_photograph_are_too_few() -> None:
    failed([], "too-few-photos")
    failed(survey_photos(ROOM, STATIONS[:1]), "too-few-photos")


def test_photographs_without_targets() -> None:
    empty = Detection(CAMERA.width_px, CAMERA.height_px, ())
    photos = [replace(photo, detection=empty) for photo in survey_photos(ROOM, STATIONS[:3])]
    error = failed(photos, "no-targets")
    assert "code family" in error.detail


def test_one_photograph_without_targets_is_named() -> None:
    photos = survey_photos(ROOM, STATIONS)
    photos[5] = replace(photos[5], detection=Detection(CAMERA.width_px, CAMERA.height_px, ()))
    result = adjust_survey(photos, CONTROL, PLATE)
    assert result.unoriented == (("photo05.jpg", "no target was found in it"),)


def test_photographs_that_share_nothing() -> None:
    photos = []
    for number, photo in enumerate(survey_photos(ROOM, STATIONS[:4])):
        targets = tuple(replace(seen, code=seen.code + 100 * number) for seen in photo.detection.targets)
        photos.append(replace(photo, detection=replace(photo.detection, targets=targets)))
    assert "three places" in failed(photos, "no-overlap").detail


def test_two_views_give_no_map() -> None:
    failed(survey_photos(ROOM, STATIONS[:2]), "no-intersection")


def test_codes_that_mean_nothing_give_no_map() -> None:
    """Every code drawn at random: single targets always agree with the pose they give, two never."""
    rng = np.random.default_rng(0)
    photos = []
    for photo in survey_photos(ROOM, STATIONS):
        codes = rng.choice(40, len(photo.detection.targets), replace=False).tolist()
        targets = tuple(replace(seen, code=code) for seen, code in zip(photo.detection.targets, codes, strict=True))
        photos.append(replace(photo, detection=replace(photo.detection, targets=targets)))
    with pytest.raises(SurveyFailed):
        adjust_survey(photos, (), PLATE)


def test_photographs_of_one_name() -> None:
    photos = survey_photos(ROOM, STATIONS[:3])
    error = failed([*photos, photos[0]], "duplicate-names")
    assert error.fields["photos"] == ["photo00.jpg"]


def test_a_camera_without_focal_length_is_named() -> None:
    stranger = CameraIdentity("", "", 1920, 1080)
    photos = survey_photos(ROOM, STATIONS)
    photos[2] = replace(photos[2], identity=stranger)
    (name, reason), *others = adjust_survey(photos, CONTROL, PLATE).unoriented
    assert name == "photo02.jpg"
    assert "35 mm" in reason
    assert not others
    failed([replace(photo, identity=stranger) for photo in photos], "unknown-camera")


def two_rooms() -> tuple[list[SurveyPhoto], Room]:
    """Sixteen photographs of one room and ten of another, whose codes are 200 higher."""
    other = build_room(seed=5)
    other = Room(
        {code + 200: pose for code, pose in other.poses.items()},
        {code + 200: plate for code, plate in other.plates_m.items()},
    )
    return survey_photos(ROOM, STATIONS) + survey_photos(other, ring_of_stations(10), first=50), other


def test_of_two_parts_the_larger_is_taken_and_the_rest_named() -> None:
    photos, _ = two_rooms()
    result = adjust_survey(photos, (), PLATE)
    assert len(result.photos) == 16
    assert len(result.unoriented) == 10
    assert all("part of 10 photographs" in reason for _, reason in result.unoriented)


def test_of_two_parts_the_one_with_control_is_taken() -> None:
    photos, other = two_rooms()
    points = control_points(other, [(code + 200, dot) for code, dot in CONTROL_DOTS])
    result = adjust_survey(photos, points, PLATE)
    assert {photo.name for photo in result.photos} == {photo.name for photo in photos[16:]}
    assert np.abs(dot_errors_m(other, result.target_map.targets)).max() < 0.01


def test_control_spread_over_two_parts() -> None:
    photos, other = two_rooms()
    points = control_points(ROOM, CONTROL_DOTS[:2])
    points += control_points(other, [(code + 200, dot) for code, dot in CONTROL_DOTS[2:]])
    with pytest.raises(SurveyFailed) as caught:
        adjust_survey(photos, points, PLATE)
    assert caught.value.fields["reason"] == "control-in-parts"
    assert sorted(len(part) for part in caught.value.fields["parts"]) == [10, 16]


@pytest.mark.parametrize("stage", ["network", "adjust", "control", "covariance"])
def test_a_survey_may_be_cancelled_at_every_stage(stage: str) -> None:
    told: list[str] = []

    def progress(name: str, done: int, total: int) -> None:
        told.append(name)
        assert 0 <= done <= total
        if name == stage:
            raise Cancelled("stopped on request")

    with pytest.raises(Cancelled):
        adjust_survey(survey_photos(ROOM, STATIONS), CONTROL, PLATE, progress=progress)
    assert told[-1] == stage


def test_the_order_of_photographs_changes_nothing_but_rounding() -> None:
    photos = survey_photos(ROOM, STATIONS)
    forwards = adjust_survey(photos, CONTROL, PLATE)
    backwards = adjust_survey(photos[::-1], CONTROL, PLATE)
    for target, other in zip(forwards.target_map.targets, backwards.target_map.targets, strict=True):
        assert target.code == other.code
        # Both ended within a thousandth of a sigma of a millimetre.
        np.testing.assert_allclose(target.dots_m, other.dots_m, atol=1e-5)


def test_dots_are_where_pose_and_print_put_them(good: SurveyResult) -> None:
    for target in good.target_map.targets:
        side_m = np.linalg.norm(target.dots_m[3] - target.dots_m[0])
        assert side_m == pytest.approx(9.0 * U_M * good.report.print_scale.scale[0], rel=1e-9)
