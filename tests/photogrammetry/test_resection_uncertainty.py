"""Honest covariances: redraws of all that errs scatter as the covariance says, even where least squares flatters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from app.errors import NotLocated
from app.geometry.target_map import Datum
from app.photogrammetry.resection import resect
from app.photogrammetry.resection_adjustment import adjust_pose
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from app.photogrammetry.resection_uncertainty import pose_uncertainty, variance_factor
from tests.photogrammetry.resection_scene import (
    DATUM_SIGMAS,
    Scene,
    calibrated,
    looking,
    map_of,
    observe,
    plate,
    pose_error,
    redrawn_camera,
    redrawn_map,
    room_scene,
)

DATUM = Datum(np.array([4.0, 4.0, 1.3]), np.diag(DATUM_SIGMAS**2))
DRAWS = 1000


def normalised_errors(scene: Scene, draws: int, seed: int) -> npt.NDArray[np.float64]:
    """Squared errors over covariance of redraws of dots, map, datum and camera; of those that were located."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(draws):
        camera = redrawn_camera(scene.camera, rng)
        try:
            resection = resect(observe(scene, rng), redrawn_map(scene.target_map, rng), camera)
        except NotLocated:
            continue
        error = pose_error(resection.site_from_cam, scene.site_from_cam)
        found.append(float(error @ np.linalg.solve(resection.covariance, error)))
    return np.array(found)


def single(distance_m: float, tilt_rad: float) -> Scene:
    target = plate(5, [4.0, 7.0, 1.5], [np.sin(tilt_rad), -np.cos(tilt_rad), 0.0], 0.2)
    return Scene(looking([4.0, 7.0 - distance_m, 1.5], [4.02, 7.0, 1.48]), map_of([target], DATUM), calibrated())


def test_normalised_error_of_a_thousand_redraws_is_six() -> None:
    errors = normalised_errors(room_scene(4, 21, DATUM), DRAWS, seed=1)
    assert len(errors) == DRAWS
    # A chi-square of six scatters by sqrt(12): 0.11 in the mean of 1,000, and 2.5 of that.
    assert errors.mean() == pytest.approx(6.0, abs=0.28)
    assert errors.var() == pytest.approx(12.0, rel=0.35)


@pytest.mark.parametrize(("distance_m", "tilt_rad"), [(0.8, 0.0), (1.0, 0.5), (3.0, 0.6)])
def test_one_clear_plate_is_located_with_an_honest_covariance(distance_m: float, tilt_rad: float) -> None:
    errors = normalised_errors(single(distance_m, tilt_rad), 80, seed=2)
    assert len(errors) >= 76
    # 0.39 in the mean of 80; the covariance may be wider than needed by the checks against flatness.
    assert 4.0 < errors.mean() < 6.0 + 4.0 * 0.39


def test_what_passes_of_a_frontal_far_plate_is_not_flattered() -> None:
    errors = normalised_errors(single(2.3, 0.0), 50, seed=3)
    assert len(errors) < 50  # some are refused
    assert np.median(errors) < 9.0  # of a chi-square of six: 5.3


def test_a_flat_minimum_is_widened_and_a_sharp_one_is_not() -> None:
    def greatest_widening(scene: Scene) -> float:
        rng, prior = np.random.default_rng(4), CameraPrior.of(scene.camera)
        found = []
        for _ in range(10):
            seen = sight_targets(observe(scene, rng), scene.target_map)
            adjusted = adjust_pose(seen, prior, State(scene.site_from_cam, np.zeros(9)))
            found.append(pose_uncertainty(seen, prior, adjusted).widening)
        return max(found)

    assert greatest_widening(single(0.6, 0.5)) < 1.1
    assert greatest_widening(single(3.5, 0.0)) > 1.5


def test_rounding_does_not_decide_how_far_a_flat_minimum_is_widened() -> None:
    scene = single(2.0, 0.05)
    prior, rng = CameraPrior.of(scene.camera), np.random.default_rng(7)
    observation, widenings = observe(scene, rng)[0], []
    for _ in range(6):
        # 1e-9 px is nothing to a dot of 0.08 px, and ten thousand times the rounding of its coordinates.
        shaken = replace(observation, centres_px=observation.centres_px + rng.normal(0.0, 1e-9, (16, 2)))
        seen = sight_targets([shaken], scene.target_map)
        adjusted = adjust_pose(seen, prior, State(scene.site_from_cam, np.zeros(9)))
        widenings.append(pose_uncertainty(seen, prior, adjusted).widening)
    assert widenings[0] > 1.0
    np.testing.assert_allclose(widenings, widenings[0], rtol=1e-6)


def test_covariance_is_scaled_when_dots_scatter_more_than_they_say() -> None:
    scene = room_scene(10, 2)
    rng = np.random.default_rng(0)
    flattered = [
        replace(observation, covariances_px2=observation.covariances_px2 / 4.0) for observation in observe(scene, rng)
    ]
    seen, prior = sight_targets(flattered, scene.target_map), CameraPrior.of(scene.camera)
    adjusted = adjust_pose(seen, prior, State(scene.site_from_cam, np.zeros(9)))
    # Dots that scatter twice as much as they say: four, plus or minus 3 sigmas of 314 coordinates; map errors weigh in.
    assert variance_factor(seen, adjusted) == pytest.approx(4.0, rel=3.0 * np.sqrt(2.0 / 314.0) + 0.1)


def test_covariance_is_left_alone_by_chance() -> None:
    scene = room_scene(10, 2)
    prior = CameraPrior.of(scene.camera)
    factors = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        seen = sight_targets(observe(scene, rng), redrawn_map(scene.target_map, rng))
        factors.append(variance_factor(seen, adjust_pose(seen, prior, State(scene.site_from_cam, np.zeros(9)))))
    assert np.mean(np.array(factors) > 1.0) < 0.15  # two tests of 1 % each


def test_the_datum_is_added_once() -> None:
    scene = room_scene(6, 3, DATUM)
    observations = observe(scene)
    certain = resect(observations, scene.with_targets(scene.target_map.targets).target_map, scene.camera)
    free = resect(observations, map_of(scene.target_map.targets), scene.camera)
    np.testing.assert_allclose(
        certain.covariance - free.covariance,
        DATUM.pose_covariance(free.site_from_cam.position_m),
        rtol=1e-6,
        atol=1e-15,
    )
