"""A snapshot in motion: the pose of its middle row, honest; and what the same costs where the readout is not known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from app.errors import NotLocated
from app.photogrammetry.resection import resect
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from app.photogrammetry.rolling_shutter.cost import motion_cost
from app.photogrammetry.rolling_shutter.equations import Moving, moving_rows
from app.photogrammetry.rolling_shutter.motion import MotionOptions
from app.photogrammetry.rolling_shutter.resect import resect_moving
from tests.photogrammetry.resection_scene import (
    displaced,
    observe,
    pose_error,
    redrawn_camera,
    redrawn_map,
    room_scene,
)
from tests.photogrammetry.rolling_shutter.moving_scene import READOUT, observe_moving, random_motion

SPEED_M_S, TURN_RAD_S = 1.0, 0.5
TRIALS = 25


def test_poses_and_movements_err_as_their_covariances_say() -> None:
    poses, motions = [], []
    for seed in range(TRIALS):
        rng = np.random.default_rng(seed)
        scene, motion = room_scene(12, seed), random_motion(rng, SPEED_M_S, TURN_RAD_S)
        camera = replace(redrawn_camera(scene.camera, rng), readout=READOUT)
        observations = observe_moving(scene, motion, rng)
        found = resect_moving(observations, redrawn_map(scene.target_map, rng), camera)
        assert found.motion is not None
        error, off = pose_error(found.resection.site_from_cam, scene.site_from_cam), found.motion.values - motion
        poses.append(float(error @ np.linalg.solve(found.resection.covariance, error)))
        motions.append(float(off @ np.linalg.solve(found.motion.covariance, off)))
    low, high = chi2.ppf([1e-4, 1 - 1e-4], 6 * TRIALS)
    assert low < sum(poses) < high
    assert low < sum(motions) < high


def test_without_the_readout_the_same_picture_is_refused_or_far_off() -> None:
    rng = np.random.default_rng(3)
    scene = room_scene(12, 3)
    observations = observe_moving(scene, random_motion(rng, SPEED_M_S, TURN_RAD_S), rng)
    with pytest.raises(NotLocated) as refused:
        resect(observations, scene.target_map, scene.camera)
    assert refused.value.fields["reason"] == "inconsistent"


def test_a_camera_without_readout_is_resected_as_it_always_was() -> None:
    scene = room_scene(8, 1)
    observations = observe(scene, np.random.default_rng(1))
    found = resect_moving(observations, scene.target_map, scene.camera)
    assert found.motion is None
    assert found.observations == tuple(observations)
    assert np.array_equal(found.resection.covariance, resect(observations, scene.target_map, scene.camera).covariance)


def test_a_target_that_was_moved_is_refused_in_motion_too() -> None:
    rng = np.random.default_rng(5)
    scene = room_scene(10, 5)
    first, *others = scene.target_map.targets
    observations = observe_moving(
        scene.with_targets([displaced(first, np.array([0.05, 0.0, 0.05]), np.zeros(3)), *others]),
        random_motion(rng, SPEED_M_S, TURN_RAD_S),
        rng,
    )
    found = resect_moving(observations, scene.target_map, replace(scene.camera, readout=READOUT))
    assert [target.code for target in found.resection.targets if not target.used] == [first.code]


def test_the_cost_is_what_a_movement_shifts() -> None:
    """Slow, so that nothing is refused: the pose shifts by about the cost."""
    scene, slow = room_scene(20, 2), 0.02
    still = resect(observe(scene), scene.target_map, scene.camera)
    cost = motion_cost(still.site_from_cam, observe(scene), scene.target_map, scene.camera, READOUT)
    shifts_m = []
    for direction in np.eye(3):
        seen = observe_moving(scene, np.concatenate([slow * direction, np.zeros(3)]), np.random.default_rng(0))
        quiet = observe_moving(scene, np.zeros(6), np.random.default_rng(0))
        poses = [resect(dots, scene.target_map, scene.camera).site_from_cam.position_m for dots in (seen, quiet)]
        shifts_m.append(float(np.linalg.norm(poses[0] - poses[1])))
    # The cost weighs each dot alike; a resection by its accuracy, and its target's, and gives way in the camera.
    assert 1.0 / 3.0 < max(shifts_m) / (slow * cost.position_m_per_m_s) < 3.0


def test_derivatives_are_those_of_the_images() -> None:
    scene = room_scene(3, 4)
    sighted, prior = sight_targets(observe(scene), scene.target_map), CameraPrior.of(scene.camera)
    times_s = READOUT.times_s(sighted.observed_px, 1920, 1080)
    at = Moving(State(scene.site_from_cam, np.zeros(9)), np.array([0.4, -0.3, 0.2, 0.1, 0.2, -0.3]))
    rows, small = moving_rows(sighted, prior, at, times_s), 1e-6
    for column, step in enumerate(small * np.eye(21)):
        ahead, behind = (moving_rows(sighted, prior, at.moved(sign * step), times_s) for sign in (1.0, -1.0))
        numeric = (ahead.computed_px - behind.computed_px) / (2.0 * small)
        # Turns at different times are added and not composed: off by half the turn in between, 5 mrad at the most.
        scale = np.abs(numeric).max()
        assert np.abs(rows.unknowns[..., column] - numeric).max() <= 0.01 * scale


def test_a_movement_is_supposed_to_be_possible() -> None:
    with pytest.raises(ValueError, match="movement"):
        MotionOptions(speed_m_s=0.0)
