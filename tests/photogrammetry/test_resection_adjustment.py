"""Least squares of one photograph: exact on exact dots, from afar, and with a camera that needs calibrating."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.rotation import angle_between_deg
from app.photogrammetry.resection_adjustment import AdjustmentOptions, adjust_pose, evaluate
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from tests.photogrammetry.resection_scene import calibrated, observe, pose_error, room_scene

AT_HOME = np.zeros(9)


@given(seed=st.integers(0, 10_000), start=st.tuples(*[st.floats(-0.15, 0.15)] * 6))
@settings(max_examples=20, deadline=None)
def test_exact_dots_lead_home_from_a_start_that_is_off_by_degrees_and_decimetres(
    seed: int, start: tuple[float, ...]
) -> None:
    scene = room_scene(5, seed)
    seen = sight_targets(observe(scene), scene.target_map)
    step = np.concatenate([start, AT_HOME])
    adjusted = adjust_pose(seen, CameraPrior.of(scene.camera), State(scene.site_from_cam, AT_HOME).moved(step))
    assert adjusted.converged
    error = pose_error(adjusted.state.site_from_cam, scene.site_from_cam)
    # A last step of up to 0.002 is taken as linear, which leaves its square of the 6 m to the targets: 0.024 mm.
    assert np.abs(error).max() < 3e-5
    assert adjusted.chi2 < 0.1


def test_the_optimum_is_a_minimum_of_the_sum_of_squares() -> None:
    scene = room_scene(6, 3)
    seen, prior = (
        sight_targets(observe(scene, np.random.default_rng(1)), scene.target_map),
        CameraPrior.of(scene.camera),
    )
    adjusted = adjust_pose(seen, prior, State(scene.site_from_cam, AT_HOME))
    covariance = np.linalg.inv(adjusted.information)
    at_optimum = evaluate(seen, prior, adjusted.state).chi2
    for axis in range(15):
        one_sigma = covariance[:, axis] / np.sqrt(covariance[axis, axis])
        for sign in (-1.0, 1.0):
            rise = evaluate(seen, prior, adjusted.state.moved(sign * one_sigma)).chi2 - at_optimum
            # A step of one sigma along its own regression line raises a quadratic by one.
            assert rise == pytest.approx(1.0, abs=0.05)


def test_a_poor_prior_is_calibrated_by_many_targets_and_kept_by_one_frontal() -> None:
    camera = calibrated(50.0)  # 40 px of the focal length, 3 %
    scene = room_scene(12, 1)
    off = camera.camera.with_intrinsics(camera.camera.intrinsics + 40.0 * np.isin(np.arange(9), [0, 1]))
    seen = sight_targets(observe(scene), scene.target_map)
    prior = CameraPrior.of(replace(camera, camera=off))
    adjusted = adjust_pose(seen, prior, State(scene.site_from_cam, AT_HOME))
    focal_sigma_px = np.sqrt((prior.root @ np.linalg.inv(adjusted.information)[6:, 6:] @ prior.root.T)[0, 0])
    assert focal_sigma_px < 5.0
    assert prior.camera_at(adjusted.state.whitened).fx_px == pytest.approx(
        scene.camera.camera.fx_px, abs=3 * focal_sigma_px
    )
    alone = adjust_pose(seen.take(np.arange(12) < 1), prior, State(scene.site_from_cam, AT_HOME))
    alone_sigma_px = np.sqrt((prior.root @ np.linalg.inv(alone.information)[6:, 6:] @ prior.root.T)[0, 0])
    assert alone_sigma_px > 20.0


def test_a_held_camera_stays() -> None:
    scene = room_scene(4, 2)
    seen = sight_targets(observe(scene, np.random.default_rng(0)), scene.target_map)
    held = adjust_pose(seen, CameraPrior.of(scene.camera), State(scene.site_from_cam, AT_HOME), free_camera=False)
    assert held.converged
    assert (held.state.whitened == 0).all()
    free = adjust_pose(seen, CameraPrior.of(scene.camera), held.state)
    assert held.attainable_chi2 == pytest.approx(free.chi2, abs=0.05)


def test_steps_end_when_they_are_used_up_and_say_so() -> None:
    scene = room_scene(4, 2)
    seen = sight_targets(observe(scene), scene.target_map)
    far = State(scene.site_from_cam, AT_HOME).moved(np.array([0.3, -0.3, 0.2, 0.1, 0.1, -0.1, *AT_HOME]))
    stopped = adjust_pose(seen, CameraPrior.of(scene.camera), far, AdjustmentOptions(max_steps=1))
    assert not stopped.converged
    assert stopped.attainable_chi2 < stopped.chi2


def test_targets_that_no_pose_sees_together_do_not_break_the_adjustment() -> None:
    scene = room_scene(3, 5)
    observations = observe(scene)
    # One target twice under two codes that stand metres apart: no camera sees that.
    observations[1] = replace(observations[0], code=observations[1].code)
    observations[2] = replace(observations[0], code=observations[2].code)
    seen = sight_targets(observations, scene.target_map)
    adjusted = adjust_pose(seen, CameraPrior.of(scene.camera), State(scene.site_from_cam, AT_HOME))
    assert np.isfinite(adjusted.information).all()
    assert adjusted.chi2 > 1e4
    assert angle_between_deg(adjusted.state.site_from_cam.rotation, scene.site_from_cam.rotation) < 180.0
