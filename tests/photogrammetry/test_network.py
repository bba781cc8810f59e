"""Sightings and networks as arrays: parts are the same numbers under other places, steps and frames compose."""

from __future__ import annotations

import numpy as np
import pytest

from app.geometry.rotation import exp_rotation
from app.geometry.similarity import Similarity
from app.photogrammetry.collinearity import whitened_residuals
from app.photogrammetry.network import NetworkStep
from app.photogrammetry.sightings import Sightings, gather_sightings
from app.targets.layout import dot_centres_u
from tests.photogrammetry.survey_scene import CAMERA, U_M, build_room, ring_of_stations, survey_photos
from tests.photogrammetry.true_network import small_truth

PLANE_M = dot_centres_u() * U_M


def test_whitening_is_the_root_of_the_information() -> None:
    photo = survey_photos(build_room(), ring_of_stations(4))[0]
    sightings, codes = gather_sightings([photo.detection])
    seen = photo.detection.targets[0]
    row = int(np.flatnonzero(codes[sightings.target] == seen.code)[0])
    for dot in range(16):
        white = sightings.whitening_per_px[row, dot]
        expected = np.linalg.inv(seen.covariances_px2[dot]) if seen.measured[dot] else np.zeros((2, 2))
        np.testing.assert_allclose(white.T @ white, expected, rtol=1e-9)
    np.testing.assert_array_equal(sightings.measured[row], seen.measured)


def test_nothing_seen_is_no_sighting() -> None:
    sightings, codes = gather_sightings([])
    assert len(sightings) == 0
    assert len(codes) == 0


def test_sightings_are_ordered_by_photograph() -> None:
    sightings = small_truth().sightings
    with pytest.raises(ValueError, match="ordered"):
        Sightings(
            sightings.photo[::-1],
            sightings.target,
            sightings.dots_px,
            sightings.whitening_per_px,
            sightings.photo_count,
            sightings.target_count,
        )


def test_a_part_has_the_residuals_of_the_whole() -> None:
    truth = small_truth()
    photos, targets = np.array([0, 2]), np.array([1, 3, 4, 7, 9])
    part, network = truth.sightings.among(photos, targets), truth.network.among(photos, targets)
    assert (part.rays() <= 2).all()
    assert len(part) == np.isin(truth.sightings.photo, photos)[np.isin(truth.sightings.target, targets)].sum()
    assert np.abs(whitened_residuals(network, part, CAMERA, PLANE_M)).max() < 1e-6
    back = truth.network.with_part(network, photos, targets)
    np.testing.assert_array_equal(back.target_positions_m, truth.network.target_positions_m)


def test_another_frame_changes_no_residual() -> None:
    truth = small_truth()
    similarity = Similarity(1.7, exp_rotation(np.array([0.4, -1.1, 0.6])), np.array([3.0, -2.0, 0.5]))
    there = truth.network.transformed(similarity)
    assert np.abs(whitened_residuals(there, truth.sightings, CAMERA, PLANE_M)).max() < 1e-6
    np.testing.assert_allclose(there.dots_m(U_M), similarity.apply(truth.network.dots_m(U_M)), atol=1e-12)


def test_many_steps_leave_a_proper_rotation() -> None:
    network = small_truth().network
    photos, targets = len(network.photo_rotations), len(network.target_rotations)
    step = NetworkStep(np.full((photos, 6), 0.1), np.full((targets, 6), -0.1), np.zeros((1, 9)), np.zeros((targets, 2)))
    for _ in range(1000):
        network = network.moved(step)
    assert np.isfinite(network.photo_pose(0).position_m).all()  # a pose checks its rotation when born
    assert np.isfinite(network.target_pose(0).position_m).all()
