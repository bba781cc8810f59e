"""The bundle: its normal equations against dense algebra, its optimum against the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from app.geometry.plate_sigmas import PlateSigmas
from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.bundle_normals import normal_equations, prior_cost, squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.equations import PointEquations, PoseEquations
from app.photogrammetry.network import Network, NetworkStep
from app.photogrammetry.prints import one_batch
from app.photogrammetry.reduced_system import Unknowns, photo_graph_tree, reduce_normals
from app.photogrammetry.robust import RobustLoss
from tests.photogrammetry.survey_scene import U_M, build_room, ring_of_stations
from tests.photogrammetry.true_network import Truth, see, small_truth

Array = npt.NDArray[np.float64]
SQUARE = RobustLoss("huber", 1e6)  # no residual of these tests is that large


def full_problem(truth: Truth) -> BundleProblem:
    """A problem with every kind of equation, slightly contradicting each other."""
    rng = np.random.default_rng(7)
    network = truth.network
    known = PoseEquations(
        np.array([2]), network.target_rotations[[2]], network.target_positions_m[[2]] + 0.001, 1e6 * np.eye(6)[None]
    )
    points = PointEquations(
        np.array([0, 1, 1]),
        rng.uniform(-0.05, 0.05, (3, 2)),
        network.target_positions_m[[0, 1, 1]],
        np.array([0.001, 0.002, 0.001]),
    )
    sightings = truth.sightings.correlated(PlateSigmas(1.4, 1.2, 0.9))
    return replace(
        truth.problem,
        sightings=sightings,
        prints=one_batch(len(network.target_rotations), 0.002),
        target_poses=known,
        points=points,
    )


def moved(network: Network, seed: int = 8) -> Network:
    """The network off by some centimetres and hundredths of a radian."""
    rng = np.random.default_rng(seed)
    photos, targets = len(network.photo_rotations), len(network.target_rotations)
    return network.moved(
        NetworkStep(
            rng.normal(0, 0.02, (photos, 6)),
            rng.normal(0, 0.02, (targets, 6)),
            rng.normal(0, 1.0, (1, 9)) * [5, 5, 3, 3, 0.01, 0.01, 1e-4, 1e-4, 0.01],
            np.tile(rng.normal(0, 0.001, 2), (targets, 1)),
        )
    )


def cost_along(problem: BundleProblem, network: Network, direction: Array, size: float) -> float:
    """Weighted squares after a step in all unknowns: photographs, targets, intrinsics, print scale."""
    photos, targets = len(network.photo_rotations), len(network.target_rotations)
    parts = np.split(size * direction, np.cumsum([6 * photos, 6 * targets, 9]))
    step = NetworkStep(
        parts[0].reshape(-1, 6), parts[1].reshape(-1, 6), parts[2].reshape(1, 9), np.tile(parts[3], (targets, 1))
    )
    there = network.moved(step)
    return float(squared_residuals(problem, there).sum()) + prior_cost(problem, there)


def test_the_gradient_is_the_slope_of_the_cost() -> None:
    truth = small_truth()
    problem, network = full_problem(truth), moved(truth.network)
    normals = normal_equations(problem, network, SQUARE)
    gradient = np.concatenate(
        [normals.photo_gradient.ravel(), normals.target_gradient.ravel(), normals.border_gradient]
    )
    rng = np.random.default_rng(9)
    for _ in range(5):
        direction = rng.normal(size=len(gradient)) * np.sqrt(1.0 / np.maximum(np.abs(gradient), 1.0))
        size = 1e-6
        slope = (cost_along(problem, network, direction, size) - cost_along(problem, network, direction, -size)) / (
            2.0 * size
        )
        assert slope == pytest.approx(2.0 * gradient @ direction, rel=1e-4)


def test_the_reduced_system_solves_the_whole() -> None:
    truth = small_truth()
    problem = full_problem(truth)
    normals = normal_equations(problem, truth.network, SQUARE)
    photos, targets = len(normals.photos), len(normals.targets)
    border = len(normals.border)
    dense = np.zeros((6 * (photos + targets) + border,) * 2)
    for photo in range(photos):
        rows = slice(6 * photo, 6 * photo + 6)
        dense[rows, rows], dense[rows, -border:] = normals.photos[photo], normals.photo_border[photo]
    for target in range(targets):
        rows = slice(6 * (photos + target), 6 * (photos + target) + 6)
        dense[rows, rows], dense[rows, -border:] = normals.targets[target], normals.target_border[target]
    for row, (photo, target) in enumerate(zip(problem.sightings.photo, problem.sightings.target, strict=True)):
        place = 6 * (photos + target)
        dense[6 * photo : 6 * photo + 6, place : place + 6] = normals.photo_target[row]
    dense[-border:, -border:] = normals.border
    dense = np.triu(dense) + np.triu(dense, 1).T
    right = np.random.default_rng(10).normal(size=(len(dense), 2))
    expected = np.linalg.solve(dense, right)

    reduced = reduce_normals(normals, problem.sightings, problem.free_border, photo_graph_tree(problem.sightings))
    parts = np.split(right, [6 * photos, 6 * (photos + targets)])
    found = reduced.solve(Unknowns(*parts))
    solution = np.concatenate([found.photos, found.targets, found.border])
    # Metres, pixels and k3 in one matrix: its condition number times the rounding of a double.
    rounding = np.linalg.cond(dense) * np.finfo(np.float64).eps
    assert rounding < 1e-2
    np.testing.assert_allclose(solution, expected, atol=rounding * np.abs(expected).max())


def test_exact_photographs_lead_back_to_the_truth() -> None:
    truth = see(build_room(), ring_of_stations(8))
    adjusted = adjust_bundle(truth.problem, with_what_is_held(truth.network, moved(truth.network)))
    assert adjusted.converged
    # The last step lowered the squares by 1e-6 of a variance at most, and steps shrink quadratically: 1e-3 of sigmas
    # of a millimetre.
    np.testing.assert_allclose(adjusted.network.dots_m(U_M), truth.network.dots_m(U_M), atol=1e-6)
    np.testing.assert_allclose(adjusted.network.photo_positions_m, truth.network.photo_positions_m, atol=1e-6)


def with_what_is_held(truth: Network, network: Network) -> Network:
    """The network with the pose that holds the frame and the print that holds the scale."""
    rotations, positions_m = network.photo_rotations.copy(), network.photo_positions_m.copy()
    rotations[0], positions_m[0] = truth.photo_rotations[0], truth.photo_positions_m[0]
    return replace(network, photo_rotations=rotations, photo_positions_m=positions_m, print_scale=truth.print_scale)


def test_a_held_print_stays_and_a_free_one_is_found() -> None:
    truth = see(build_room(scale_xy=(1.001, 0.9985)), ring_of_stations(8))
    points = PointEquations(
        np.arange(6),
        np.zeros((6, 2)),
        truth.network.target_positions_m[:6],
        np.full(6, 1e-5),
    )
    held = adjust_bundle(truth.problem, truth.network)
    assert (held.network.print_scale == 1.0).all()
    free = replace(truth.problem, points=points, prints=one_batch(len(truth.codes), 0.1), photo_poses=None)
    found = adjust_bundle(free, truth.network).network.print_scale[0]
    np.testing.assert_allclose(found, [1.001, 0.9985], atol=1e-5)  # a centre known to 1e-5 of some metres


def test_a_false_sighting_is_forgotten() -> None:
    truth = see(build_room(), ring_of_stations(8))
    dots_px = truth.sightings.dots_px.copy()
    dots_px[5] += 200.0
    problem = truth.problem.with_sightings(replace(truth.sightings, dots_px=dots_px))
    adjusted = adjust_bundle(problem, truth.network, BundleOptions(loss=RobustLoss("cauchy", 3.0)))
    # 200 px are 0.7 m at these distances; what the loss leaves of them is less than the noise of a photograph.
    np.testing.assert_allclose(adjusted.network.target_positions_m, truth.network.target_positions_m, atol=2e-3)


def test_a_caller_may_stop_it() -> None:
    truth = small_truth()

    class Stopped(Exception):
        pass

    def stop() -> None:
        raise Stopped

    with pytest.raises(Stopped):
        adjust_bundle(truth.problem, truth.network, on_step=stop)
