"""Snapshot to pose, whole: exact truth, every attitude, partial and wrong targets, and what is reported."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import NotLocated
from app.geometry.camera import CameraIdentity
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation, photogrammetric_angles_deg
from app.photogrammetry.camera_for_photo import cameras_for_photo
from app.photogrammetry.camera_prior import camera_from_exif
from app.photogrammetry.resection import Resection, resect
from tests.photogrammetry.resection_scene import (
    Scene,
    calibrated,
    displaced,
    is_in_view,
    looking,
    map_of,
    observe,
    plate,
    pose_error,
    room_scene,
)


def located(scene: Scene, seed: int | None = None) -> Resection:
    rng = None if seed is None else np.random.default_rng(seed)
    return resect(observe(scene, rng), scene.target_map, scene.camera)


def normalised_error(resection: Resection, truth: Pose) -> float:
    error = pose_error(resection.site_from_cam, truth)
    return float(error @ np.linalg.solve(resection.covariance, error))


@given(seed=st.integers(0, 100_000), count=st.integers(3, 15))
@settings(max_examples=25, deadline=None)
def test_exact_dots_give_the_exact_pose(seed: int, count: int) -> None:
    scene = room_scene(count, seed)
    resection = located(scene)
    # A last step of up to 0.002 is taken as linear, which leaves its square of the 6 m to the targets: 0.024 mm.
    assert np.abs(pose_error(resection.site_from_cam, scene.site_from_cam)).max() < 3e-5
    assert resection.sigma0 < 0.05
    assert resection.variance_factor == 1.0
    assert resection.redundancy == 32 * count - 6
    assert all(target.used and target.reason is None for target in resection.targets)


@pytest.mark.parametrize("roll_rad", [0.0, np.pi / 2, np.pi, -2.0])
@pytest.mark.parametrize("at_m", [(4.0, 9.0, 1.5), (4.5, 8.0, 1.2), (1.0, 8.0, 0.8)])
def test_every_attitude_is_located(roll_rad: float, at_m: tuple[float, float, float]) -> None:
    # (4, 9, 1.5) is straight along the site's Y, where phi and kappa do not exist.
    site_from_cam = looking([4.0, 4.0, 1.5], at_m, roll_rad)
    rng = np.random.default_rng(5)
    aim = np.array(at_m) - [4.0, 4.0, 1.5]
    targets = []
    for code in range(1, 200):
        centre_m = site_from_cam.position_m + aim * rng.uniform(0.5, 1.0) + rng.normal(0.0, 0.8, 3)
        target = plate(code, centre_m, -aim + rng.normal(0.0, 1.5, 3))
        if (
            is_in_view(target, site_from_cam)
            and (site_from_cam.position_m - centre_m) @ target.site_from_target.rotation[:, 2] > 1.0
        ):
            targets.append(target)
    scene = Scene(site_from_cam, map_of(targets[:8]), calibrated())
    resection = located(scene, 1)
    assert normalised_error(resection, site_from_cam) < 30.0
    along_y = abs(site_from_cam.rotation[1, 2]) > 0.9999
    assert (photogrammetric_angles_deg(resection.site_from_cam.rotation) is None) == along_y


def test_a_photograph_from_any_place_of_the_site_frame_is_the_same_photograph() -> None:
    scene = room_scene(6, 9)
    here = located(scene, 2)
    moved = Pose(exp_rotation(np.array([0.3, -2.0, 1.0])), np.array([100.0, -50.0, 20.0]))
    targets = [
        replace(
            target,
            site_from_target=moved.compose(target.site_from_target),
            dots_m=moved.apply(target.dots_m),
            covariance=np.kron(np.eye(2), moved.rotation) @ target.covariance @ np.kron(np.eye(2), moved.rotation).T,
        )
        for target in scene.target_map.targets
    ]
    there = resect(observe(scene, np.random.default_rng(2)), map_of(targets), scene.camera)
    expected = moved.compose(here.site_from_cam)
    np.testing.assert_allclose(there.site_from_cam.position_m, expected.position_m, atol=1e-6)
    turn = np.kron(np.eye(2), moved.rotation)
    np.testing.assert_allclose(there.covariance, turn @ here.covariance @ turn.T, rtol=1e-3, atol=1e-12)
    assert there.sigma0 == pytest.approx(here.sigma0, rel=1e-4)


def test_targets_all_in_one_plane_are_enough() -> None:
    site_from_cam = looking([4.0, 3.0, 1.5], [4.3, 9.0, 1.4])
    wall = [plate(code, [2.5 + 0.4 * code, 9.0, 1.0 + 0.2 * (code % 4)]) for code in range(8)]
    scene = Scene(site_from_cam, map_of(wall), calibrated())
    for seed in range(5):
        assert normalised_error(located(scene, seed), site_from_cam) < 30.0


@pytest.mark.parametrize("distance_m", [0.35, 2.0, 9.0])
def test_near_and_far(distance_m: float) -> None:
    site_from_cam = looking([4.0, 9.0 - distance_m, 1.5], [4.0, 9.0, 1.5], 0.1)
    spread_m = 0.16 * distance_m
    targets = [
        plate(1, [4.0 - spread_m, 9.0, 1.5], [0.4, -1.0, 0.1]),
        plate(2, [4.0 + spread_m, 9.0, 1.5 + 0.3 * spread_m], [-0.2, -1.0, 0.3]),
        plate(3, [4.0, 9.0 + 2.0 * spread_m, 1.5 - spread_m], [0.1, -1.0, 0.2]),
    ]
    scene = Scene(site_from_cam, map_of(targets), calibrated())
    resection = located(scene, 3)
    assert normalised_error(resection, site_from_cam) < 30.0
    assert np.sqrt(np.trace(resection.covariance[:3, :3])) < 0.02 * distance_m


@pytest.mark.parametrize("shift_m", [0.02, 0.05, 0.3])
@pytest.mark.parametrize("which", [0, 1, 2])
def test_one_moved_target_of_three_does_not_move_the_pose_and_is_named(which: int, shift_m: float) -> None:
    scene = room_scene(3, 14)
    targets = list(scene.target_map.targets)
    targets[which] = displaced(targets[which], shift_m * np.array([0.6, 0.3, -0.7]), np.array([0.0, 0.0, shift_m]))
    observations = observe(scene, np.random.default_rng(4))
    disturbed = resect(observations, scene.with_targets(targets).target_map, scene.camera)
    code = targets[which].code
    undisturbed = resect(
        [seen for seen in observations if seen.code != code], scene.without(code).target_map, scene.camera
    )
    error = pose_error(disturbed.site_from_cam, undisturbed.site_from_cam)
    assert (np.abs(error) < np.sqrt(np.diag(undisturbed.covariance))).all()
    fate = disturbed.targets[which]
    assert (fate.code, fate.used, fate.reason) == (code, False, "moved-or-misread")
    assert fate.rms_px is not None and fate.rms_px > 1.0


def test_misread_and_unknown_targets_are_named_and_take_no_part() -> None:
    scene = room_scene(5, 15)
    observations = observe(scene, np.random.default_rng(6))
    observations[1] = replace(observations[1], code=900)
    wrong = scene.without(2)
    misread = [*observations[:4], replace(observations[4], code=2)]
    mapped = scene.with_targets(
        [*wrong.target_map.targets[:3], displaced(scene.target_map.by_code[2], np.zeros(3), np.zeros(3))]
    )
    resection = resect(misread, mapped.target_map, scene.camera)
    fates = {target.code: (target.used, target.reason) for target in resection.targets}
    assert fates[900] == (False, "unknown-target")
    assert fates[2] == (False, "moved-or-misread")
    assert [target.code for target in resection.targets] == [1, 900, 3, 4, 2]
    assert normalised_error(resection, scene.site_from_cam) < 30.0


@pytest.mark.parametrize("seed", range(8))
def test_two_targets_that_swapped_their_codes_are_left_out(seed: int) -> None:
    scene = room_scene(6, seed + 10)
    first, second, *others = observe(scene, np.random.default_rng(seed))
    swapped = [replace(first, code=second.code), replace(second, code=first.code), *others]
    resection = resect(swapped, scene.target_map, scene.camera)
    assert [target.used for target in resection.targets] == [False, False, True, True, True, True]
    assert normalised_error(resection, scene.site_from_cam) < 30.0


def hidden(observation: TargetObservation, cells: list[int]) -> TargetObservation:
    """The observation with only some cells measured and the others nowhere."""
    measured = np.isin(np.arange(16), cells)
    return replace(observation, measured=measured, centres_px=np.where(measured[:, None], observation.centres_px, 0.0))


def test_partly_hidden_targets_count_with_the_dots_they_have() -> None:
    scene = room_scene(4, 16)
    observations = observe(scene, np.random.default_rng(7))
    observations[0] = hidden(observations[0], [0, 1, 4, 5, 6, 9])
    observations[1] = hidden(observations[1], [12])
    resection = resect(observations, scene.target_map, scene.camera)
    assert resection.redundancy == 2 * (6 + 1 + 16 + 16) - 6
    assert normalised_error(resection, scene.site_from_cam) < 30.0
    without = resect(observations[2:], scene.target_map, scene.camera)
    assert np.trace(resection.covariance[:3, :3]) < np.trace(without.covariance[:3, :3])


def test_a_partly_seen_neighbour_settles_an_ambiguous_plate() -> None:
    normal = [0.5, -1.0, 0.0]
    targets = [plate(1, [4.0, 8.0, 1.5], normal), plate(2, [5.2, 7.0, 1.9], [-0.5, -1.0, 0.2])]
    scene = Scene(looking([4.0, 1.5, 1.5], [4.3, 8.0, 1.5]), map_of(targets), calibrated())
    for seed in range(5):
        first, second = observe(scene, np.random.default_rng(seed))
        resection = resect([first, hidden(second, [0, 1, 2, 3, 5])], scene.target_map, scene.camera)
        assert normalised_error(resection, scene.site_from_cam) < 30.0


def test_a_camera_known_from_exif_alone_locates_with_an_honest_covariance() -> None:
    scene = room_scene(8, 17)
    prior = camera_from_exif(CameraIdentity("Maker", "Phone", 1920, 1080, focal_35mm=26.0))
    resection = resect(observe(scene, np.random.default_rng(8)), scene.target_map, prior)
    assert normalised_error(resection, scene.site_from_cam) < 30.0
    surveyed = resect(observe(scene, np.random.default_rng(8)), scene.target_map, scene.camera)
    assert np.trace(resection.covariance[:3, :3]) > np.trace(surveyed.covariance[:3, :3])


def test_a_frame_stored_on_its_side_fits_under_the_right_quarter_turn() -> None:
    scene = room_scene(6, 18)
    upright = observe(scene, np.random.default_rng(9))
    height_px = scene.camera.camera.height_px
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])  # clockwise: new x = height - 1 - y, new y = x
    sideways = [
        replace(
            seen,
            centres_px=seen.centres_px @ turn.T + [height_px - 1, 0.0],
            covariances_px2=turn @ seen.covariances_px2 @ turn.T,
        )
        for seen in upright
    ]
    clockwise, anticlockwise = cameras_for_photo(scene.camera, 1080, 1920)
    right = resect(sideways, scene.target_map, clockwise)
    with pytest.raises(NotLocated, match="no majority"):
        resect(sideways, scene.target_map, anticlockwise)
    expected = resect(upright, scene.target_map, scene.camera)
    np.testing.assert_allclose(right.site_from_cam.position_m, expected.site_from_cam.position_m, atol=1e-6)
