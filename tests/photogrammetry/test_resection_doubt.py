"""Doubt: nobody is doubted without reason, a displaced target is, and of three the covariance covers a pose without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotLocated
from app.photogrammetry.resection import resect
from app.photogrammetry.resection_adjustment import AdjustedState, adjust_pose
from app.photogrammetry.resection_consensus import movements_chi2
from app.photogrammetry.resection_doubt import DoubtOptions, doubt_targets
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import SightedTargets, sight_targets
from tests.photogrammetry.resection_scene import Scene, displaced, observe, pose_error, redrawn_map, room_scene

NO_FLOOR = DoubtOptions(few_targets=0)


def adjusted_to(scene: Scene, seed: int, shift_m: float = 0.0) -> tuple[SightedTargets, AdjustedState]:
    """A redrawn photograph, the first target displaced sideways."""
    rng = np.random.default_rng(seed)
    first, *others = redrawn_map(scene.target_map, rng).targets
    target_map = scene.with_targets([displaced(first, np.array([shift_m, 0.0, 0.0]), np.zeros(3)), *others]).target_map
    seen = sight_targets(observe(scene, rng), target_map)
    return seen, adjust_pose(seen, CameraPrior.of(scene.camera), State(scene.site_from_cam, np.zeros(9)))


def test_good_targets_are_hardly_doubted() -> None:
    weights = []
    for seed in range(60):
        seen, adjusted = adjusted_to(room_scene(6, seed % 10), seed)
        weights.append(doubt_targets(adjusted, movements_chi2(adjusted), seen.freedoms).weights.sum())
    # Six chi-squares of six: one in 20 is looked at, with odds of a few per cent, one in 100 counts as even.
    assert np.mean(weights) < 0.15


def test_a_displaced_target_is_left_out_by_its_evidence() -> None:
    scene = room_scene(6, 3)
    seen, adjusted = adjusted_to(scene, 1, 0.01)
    doubt = doubt_targets(adjusted, movements_chi2(adjusted), seen.freedoms)
    assert doubt.weights[0] > 0.99
    without = adjust_pose(seen.take(np.arange(6) > 0), CameraPrior.of(scene.camera), adjusted.state)
    averaged = adjusted.state.moved(doubt.step).site_from_cam
    sigmas = np.sqrt(np.diag(np.linalg.inv(without.information)))[:6]
    # The step is that of the linear equations about a pose that is off by a few centimetres.
    assert (np.abs(pose_error(averaged, without.state.site_from_cam)) < 0.2 * sigmas).all()
    covariance = np.linalg.inv(adjusted.information)[:6, :6] + doubt.covariance
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), sigmas, rtol=0.1)


@pytest.mark.parametrize("shift_m", [0.003, 0.004])
def test_between_the_two_the_covariance_holds_what_they_differ_by(shift_m: float) -> None:
    seen, adjusted = adjusted_to(room_scene(6, 3), 1, shift_m)
    doubt = doubt_targets(adjusted, movements_chi2(adjusted), seen.freedoms)
    everyone = np.linalg.inv(adjusted.information)[:6, :6]
    assert np.linalg.eigvalsh(everyone + doubt.covariance).min() > 0.0
    assert np.linalg.eigvalsh(doubt.covariance).min() > -1e-9 * np.trace(doubt.covariance)
    apart = doubt.step[:6] @ np.linalg.solve(everyone + doubt.covariance, doubt.step[:6])
    assert apart < 6.0


def test_two_targets_cannot_be_doubted_and_three_always_are() -> None:
    seen, adjusted = adjusted_to(room_scene(2, 3), 1)
    assert not doubt_targets(adjusted, movements_chi2(adjusted), seen.freedoms).covariance.any()
    seen, adjusted = adjusted_to(room_scene(3, 3), 1)
    assert not doubt_targets(adjusted, movements_chi2(adjusted), seen.freedoms, NO_FLOOR).weights.all()
    weights = doubt_targets(adjusted, movements_chi2(adjusted), seen.freedoms).weights
    assert (weights >= 0.1 / 1.3 - 1e-9).all() or weights.max() > 0.5
    assert weights.sum() < 1.0


def test_one_displaced_of_three_moves_the_pose_by_no_more_than_its_sigma() -> None:
    ratios = []
    for seed in range(40):
        scene, rng = room_scene(3, seed), np.random.default_rng(seed)
        observations, target_map = observe(scene, rng), redrawn_map(scene.target_map, rng)
        direction = rng.normal(size=3)
        shift_m = rng.uniform(0.001, 0.03) * direction / np.linalg.norm(direction)
        moved = displaced(target_map.targets[seed % 3], shift_m, np.zeros(3))
        others = [target for target in target_map.targets if target.code != moved.code]
        disturbed = replace(target_map, targets=(*others, moved))
        try:
            before = resect(observations, target_map, scene.camera)
            after = resect(observations, disturbed, scene.camera)
        except NotLocated:
            continue
        shifted_m = np.linalg.norm(after.site_from_cam.position_m - before.site_from_cam.position_m)
        ratios.append(shifted_m / np.sqrt(np.trace(after.covariance[:3, :3])))
    assert len(ratios) >= 24
    # In the root mean square: single ones exceed it, as a sigma is exceeded.
    assert np.sqrt(np.mean(np.square(ratios))) < 1.2
