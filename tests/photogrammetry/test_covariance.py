"""Covariances: against a dense inverse, parted without loss, and honest about a thousand drawn errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import log_rotation
from app.geometry.target_map import Datum
from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.covariance import (
    PartedCovariances,
    part_datum,
    point_covariance,
    pose_covariances,
    reduced_at,
)
from app.photogrammetry.equations import PointEquations
from app.photogrammetry.network import Network
from app.photogrammetry.prints import one_batch
from app.photogrammetry.reduced_system import ReducedSystem, Unknowns
from app.targets.layout import dot_centres_u
from tests.photogrammetry.survey_scene import U_M, build_room, ring_of_stations
from tests.photogrammetry.true_network import Truth, see

Array = npt.NDArray[np.float64]
LOSS = BundleOptions().loss
PLANE_M = dot_centres_u() * U_M


def truth_of(noise_px: float = 0.0, seed: int = 3) -> Truth:
    return see(build_room(6), ring_of_stations(9), noise_px, seed)


def dense_target_covariance(reduced: ReducedSystem, truth: Truth) -> Array:
    """Of all targets together, column by column of the inverse, shape (6 T, 6 T)."""
    size = 6 * len(truth.codes)
    photos, border = 6 * truth.sightings.photo_count, len(reduced.factor.border)
    return reduced.solve(Unknowns(np.zeros((photos, size)), np.eye(size), np.zeros((border, size)))).targets


def test_covariances_are_the_blocks_of_the_inverse() -> None:
    truth = truth_of()
    reduced = reduced_at(truth.problem, truth.network, LOSS)
    found = pose_covariances(reduced, truth.sightings)
    dense = dense_target_covariance(reduced, truth)
    for target in range(len(truth.codes)):
        block = dense[6 * target : 6 * target + 6, 6 * target : 6 * target + 6]
        np.testing.assert_allclose(found.targets[target], block, rtol=1e-6, atol=1e-9 * np.abs(block).max())
    points = PointEquations(np.array([4, 1]), np.zeros((2, 2)), np.zeros((2, 3)), np.ones(2))
    rows = np.r_[24:27, 6:9]
    np.testing.assert_allclose(
        point_covariance(reduced, truth.network, points), dense[np.ix_(rows, rows)], rtol=1e-6, atol=1e-15
    )


def parted_of(truth: Truth) -> PartedCovariances:
    reduced = reduced_at(truth.problem, truth.network, LOSS)
    covariances = pose_covariances(reduced, truth.sightings)
    return part_datum(covariances, reduced, truth.network, np.ones(len(truth.codes), dtype=np.bool_), PLANE_M)


def test_own_parts_do_not_depend_on_what_holds_the_frame() -> None:
    truth = truth_of()
    other = replace(truth.problem.photo_poses, index=np.array([5])) if truth.problem.photo_poses else None
    assert other is not None
    first = parted_of(truth)
    problem = replace(truth.problem, photo_poses=other)
    reduced = reduced_at(problem, truth.network, LOSS)
    every = np.ones(len(truth.codes), dtype=np.bool_)
    second = part_datum(pose_covariances(reduced, truth.sightings), reduced, truth.network, every, PLANE_M)
    np.testing.assert_allclose(first.targets, second.targets, rtol=1e-4, atol=1e-12)
    np.testing.assert_allclose(first.photos, second.photos, rtol=1e-4, atol=1e-12)
    assert np.linalg.eigvalsh(first.targets).min() > 0


def errors_of(network: Network, truth: Network) -> Array:
    """Position and small rotation of the truth against the estimate, all targets, shape (T, 6)."""
    turned = log_rotation(truth.target_rotations @ np.swapaxes(network.target_rotations, -1, -2))
    return np.concatenate([truth.target_positions_m - network.target_positions_m, turned], axis=-1)


def normalised(errors: Array, covariances: Array) -> Array:
    return np.asarray(np.einsum("ti,tij,tj->t", errors, np.linalg.inv(covariances), errors))


def test_normalised_errors_of_drawn_surveys() -> None:
    """Photographs and control redrawn: each target's error is explained by its own part and the datum."""
    draws, sigma_m = 60, 0.001
    control = np.array([1, 5, 11, 17])
    whole, with_datum, own, promised = [], [], [], []
    for draw in range(draws):
        truth = truth_of(noise_px=0.1, seed=100 + draw)
        known_m = truth.network.target_positions_m[control]
        known_m = known_m + np.random.default_rng(draw).normal(0, sigma_m, (4, 3))
        points = PointEquations(control, np.zeros((4, 2)), known_m, np.full(4, sigma_m))
        problem = replace(truth.problem, photo_poses=None, points=points, prints=one_batch(len(truth.codes), 0.002))
        network = adjust_bundle(problem, truth.network).network
        reduced = reduced_at(problem, network, LOSS)
        covariances = pose_covariances(reduced, problem.sightings)
        every = np.ones(len(truth.codes), dtype=np.bool_)
        parted = part_datum(covariances, reduced, network, every, PLANE_M)
        shared = np.array([parted.datum.pose_covariance(place) for place in network.target_positions_m])
        errors = errors_of(network, truth.network)
        whole.append(normalised(errors, covariances.targets).mean())
        with_datum.append(normalised(errors, parted.targets + shared).mean())
        own.append(normalised(errors - datum_part(errors, network), parted.targets).mean())
        promised.append(np.trace(np.linalg.inv(parted.targets + shared) @ covariances.targets, axis1=1, axis2=2).mean())
    # The targets of one survey share its photographs and its datum, so surveys are the independent samples: four
    # standard errors of their mean. Parting leaves out what own errors and datum have in common, which is known.
    expected = (6.0, np.mean(promised), 6.0)
    for values, mean in zip((whole, with_datum, own), expected, strict=True):
        assert abs(np.mean(values) - mean) < 4.0 * np.std(values) / np.sqrt(draws)
    assert abs(np.mean(promised) - 6.0) < 0.6  # and is small even here, where control is no better than the network


def datum_part(errors: Array, network: Network) -> Array:
    """The small similarity that fits the errors of all dots, as errors of the poses."""
    datum = Datum(network.target_positions_m.mean(axis=0), np.zeros((7, 7)))
    design = np.zeros((len(errors), 6, 7))
    design[:, :3] = datum.point_jacobian(network.target_positions_m)
    design[:, 3:, 3:6] = np.eye(3)
    roots = np.repeat([1.0, np.sqrt((PLANE_M**2).sum(axis=-1).mean())], 3)  # a turn counts by how far it moves dots
    weighted = (design * roots[:, None]).reshape(-1, 7)
    parameters = np.linalg.lstsq(weighted, (errors * roots).ravel(), rcond=None)[0]
    return np.asarray(design @ parameters)
