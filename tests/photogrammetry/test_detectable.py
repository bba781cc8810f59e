"""The least detectable displacement is where a moved target's residuals reach the limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.detectable import least_detectable_m
from tests.photogrammetry.survey_scene import build_room, ring_of_stations
from tests.photogrammetry.true_network import see

LIMIT, SIGMA0 = 5.0, 0.9


def test_halfway_between_two_places_the_residuals_reach_the_limit_in_the_worst_direction() -> None:
    truth = see(build_room(5), ring_of_stations(8))
    detectable_m = least_detectable_m(truth.problem, truth.network, LIMIT, SIGMA0)
    # The one whose directions differ least: random ones come near the worst.
    target, sightings = int(np.argmin(detectable_m)), truth.sightings
    rows = sightings.target == target
    numbers = 2.0 * sightings.measured[rows].sum()
    rng = np.random.default_rng(1)
    reached = []
    for _ in range(400):
        direction = rng.normal(size=3)
        places_m = truth.network.target_positions_m.copy()
        places_m[target] += 0.5 * detectable_m[target] * direction / np.linalg.norm(direction)
        squared = squared_residuals(truth.problem, replace(truth.network, target_positions_m=places_m))[rows]
        reached.append(np.sqrt(squared.sum() / numbers) / SIGMA0)
    # Quadratic in the displacement, of which some millimetres at some metres leave a percent.
    assert 0.97 * LIMIT < min(reached) < 1.2 * LIMIT


def test_it_follows_the_stated_sigmas() -> None:
    truth = see(build_room(5), ring_of_stations(8))
    detectable_m = least_detectable_m(truth.problem, truth.network, LIMIT, SIGMA0)
    sharper = truth.problem.with_sightings(truth.sightings.reweighted(0.5))
    halved_m = least_detectable_m(sharper, truth.network, LIMIT, SIGMA0)
    assert (detectable_m > 0.0005).all()
    assert np.median(detectable_m) < 0.05
    ratio = halved_m / detectable_m
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)
