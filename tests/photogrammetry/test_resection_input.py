"""Observations paired with the map: whitening is the inverse root of the covariance, and taking keeps rows together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.photogrammetry.resection_input import sight_targets
from tests.photogrammetry.resection_scene import observe, room_scene


def test_whiteners_are_inverse_roots_of_the_covariances() -> None:
    scene = room_scene(3)
    observations = observe(scene)
    seen = sight_targets(observations, scene.target_map)
    w00, w10, w11 = np.moveaxis(seen.whiteners, -1, 0)
    whiteners = np.stack([np.stack([w00, np.zeros_like(w00)], -1), np.stack([w10, w11], -1)], -2)
    covariances_px2 = np.stack([observation.covariances_px2 for observation in observations])
    unit = whiteners @ covariances_px2 @ np.swapaxes(whiteners, -1, -2)
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(2), unit.shape), atol=1e-12)


def test_dots_that_were_not_measured_weigh_nothing() -> None:
    scene = room_scene(2)
    observations = observe(scene)
    hidden = np.arange(16) < 5
    observations[1] = replace(observations[1], measured=~hidden)
    seen = sight_targets(observations, scene.target_map)
    assert (seen.whiteners[1, hidden] == 0).all()
    assert seen.dot_counts.tolist() == [16, 11]


def test_rows_follow_the_observations_and_not_the_map() -> None:
    scene = room_scene(4)
    observations = observe(scene)[::-1]
    seen = sight_targets(observations, scene.target_map)
    assert seen.codes.tolist() == [4, 3, 2, 1]
    np.testing.assert_allclose(seen.dots_m[0], scene.target_map.by_code[4].dots_m, atol=1e-12)
    taken = seen.take(np.array([True, False, False, True]))
    assert taken.codes.tolist() == [4, 1]
    np.testing.assert_array_equal(taken.dots_m[1], seen.dots_m[3])
