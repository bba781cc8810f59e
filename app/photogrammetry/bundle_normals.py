"""Normal equations of a bundle: linear in the sightings, no matrix over observations.

The unknowns fall into photographs (6 each), targets (6 each) and a border shared by many: nine intrinsics per camera
and the print scale of each batch. Photographs and targets meet in one 6 x 6 block per sighting and in no other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import (
    CAMERA_COLUMNS,
    COLUMN_COUNT,
    PRINT_COLUMNS,
    linearise,
    whitened_residuals,
)
from app.photogrammetry.equations import PoseEquations
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.prints import PRINT_COUNT
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class NormalEquations:
    """Blocks of ``J' W J`` and of the gradient ``J' W residuals``; b = shared unknowns.

    Attributes
    ----------
    photos, targets : ndarray of shape (P, 6, 6), (T, 6, 6)
    border : ndarray of shape (b, b)
    photo_target : ndarray of shape (M, 6, 6)
        One block per sighting, rows of the photograph, columns of the target.
    photo_border, target_border : ndarray of shape (P, 6, b), (T, 6, b)
    photo_gradient, target_gradient, border_gradient : ndarray of shape (P, 6), (T, 6), (b,)
    """

    photos: Array
    targets: Array
    border: Array
    photo_target: Array
    photo_border: Array
    target_border: Array
    photo_gradient: Array
    target_gradient: Array
    border_gradient: Array


def squared_residuals(problem: BundleProblem, network: Network) -> Array:
    """Squared length of each dot's residual, shape (M, 16), in variances; zero where not measured."""
    squared = np.empty((len(problem.sightings), len(problem.plane_m)))
    for camera, chunk in problem.chunks():
        part = problem.sightings.select(chunk)
        residuals = whitened_residuals(network, part, problem.camera_at(network, camera), problem.plane_m)
        squared[chunk] = (residuals**2).sum(axis=-1)
    return squared


def prior_cost(problem: BundleProblem, network: Network) -> float:
    """Weighted squares of all equations but the photographs' own."""
    cost = 0.0
    for known, intrinsics in zip(problem.cameras, network.intrinsics, strict=True):
        off = intrinsics - known.camera.intrinsics
        cost += float(off @ np.linalg.solve(known.covariance, off))
    prints = problem.prints
    off = prints.off(network.print_scale)[~prints.held] / prints.sigma[~prints.held, None]
    cost += float((off**2).sum())
    if problem.photo_poses is not None:
        cost += _pose_cost(problem.photo_poses, network.photo_rotations, network.photo_positions_m)
    if problem.target_poses is not None:
        cost += _pose_cost(problem.target_poses, network.target_rotations, network.target_positions_m)
    if problem.points is not None:
        cost += float((problem.points.residuals(network) ** 2).sum())
    return cost


def _pose_cost(known: PoseEquations, rotations: Array, positions_m: Array) -> float:
    off = known.residuals(rotations, positions_m)
    return float((off[:, None] @ known.information @ off[..., None]).sum())


def normal_equations(problem: BundleProblem, network: Network, loss: RobustLoss) -> NormalEquations:
    """Normal equations at a network, each dot with its robust weight."""
    sightings, border = problem.sightings, problem.border_count
    normals = NormalEquations(
        photos=np.zeros((sightings.photo_count, POSE_COUNT, POSE_COUNT)),
        targets=np.zeros((sightings.target_count, POSE_COUNT, POSE_COUNT)),
        border=np.zeros((border, border)),
        photo_target=np.empty((len(sightings), POSE_COUNT, POSE_COUNT)),
        photo_border=np.zeros((sightings.photo_count, POSE_COUNT, border)),
        target_border=np.zeros((sightings.target_count, POSE_COUNT, border)),
        photo_gradient=np.zeros((sightings.photo_count, POSE_COUNT)),
        target_gradient=np.zeros((sightings.target_count, POSE_COUNT)),
        border_gradient=np.zeros(border),
    )
    for camera, chunk in problem.chunks():
        _add_chunk(normals, problem, network, loss, (camera, chunk))
    _add_priors(normals, problem, network)
    return normals


def _add_chunk(
    normals: NormalEquations, problem: BundleProblem, network: Network, loss: RobustLoss, run: tuple[int, slice]
) -> None:
    """Add the collinearity equations of one run of sightings of one camera."""
    camera, chunk = run
    part = problem.sightings.select(chunk)
    equations = linearise(network, part, problem.camera_at(network, camera), problem.plane_m)
    weight = loss.weight((equations.residuals**2).sum(axis=-1))
    rows = (equations.rows * np.sqrt(weight)[..., None, None]).reshape(len(part), -1, COLUMN_COUNT + 1)
    products = np.swapaxes(rows, -1, -2) @ rows  # (m, 18, 18): all of J'WJ and, in the last column, J'Wr

    by_target = products[:, :POSE_COUNT, :POSE_COUNT]
    turned = np.swapaxes(equations.target_step_from_photo_step, -1, -2)
    photo_target = turned @ by_target
    normals.photo_target[chunk] = photo_target
    _add_at(normals.photos, part.photo, photo_target @ equations.target_step_from_photo_step)
    _add_at(normals.photo_gradient, part.photo, (turned @ products[:, :POSE_COUNT, -1:])[..., 0])
    _add_at(normals.targets, part.target, by_target)
    _add_at(normals.target_gradient, part.target, products[:, :POSE_COUNT, -1])
    batch_of_row = problem.prints.batch[part.target]
    for batch in np.unique(batch_of_row):
        rows_of = batch_of_row == batch
        columns = np.r_[problem.camera_columns(camera), problem.print_columns(int(batch))]
        of_batch = part.photo[rows_of], part.target[rows_of], columns
        _add_shared(normals, products[rows_of], turned[rows_of], of_batch)


def _add_shared(normals: NormalEquations, products: Array, turned: Array, place: tuple[Index, Index, Index]) -> None:
    """Add what sightings of one camera and one print batch say of these, in their columns of the border."""
    photo, target, columns = place
    shared = np.r_[CAMERA_COLUMNS, PRINT_COLUMNS]
    by_target_shared = products[:, :POSE_COUNT, shared]
    _add_at(normals.photo_border, photo, turned @ by_target_shared, columns)
    _add_at(normals.target_border, target, by_target_shared, columns)
    summed = products.sum(axis=0)
    normals.border[np.ix_(columns, columns)] += summed[np.ix_(shared, shared)]
    normals.border_gradient[columns] += summed[shared, -1]


def _add_at(total: Array, index: Index, values: Array, columns: Index | None = None) -> None:
    """``total[index] += values`` with repeated indices summed, shape (m, ...); linear in m whatever total's length."""
    order = np.argsort(index, kind="stable")
    unique, starts = np.unique(index[order], return_index=True)
    sums = np.add.reduceat(values[order], starts, axis=0)
    if columns is None:
        total[unique] += sums
    else:
        total[unique[:, None, None], np.arange(POSE_COUNT)[:, None], columns] += sums


def _add_priors(normals: NormalEquations, problem: BundleProblem, network: Network) -> None:
    for camera, known in enumerate(problem.cameras):
        columns, information = problem.camera_columns(camera), np.linalg.inv(known.covariance)
        normals.border[columns, columns] += information
        off = network.intrinsics[camera] - known.camera.intrinsics
        normals.border_gradient[columns] += information @ off
    printed, information = problem.print_columns(), np.repeat(problem.prints.sigma**-2, PRINT_COUNT)
    normals.border[printed, printed] += np.diag(information)
    normals.border_gradient[printed] += information * problem.prints.off(network.print_scale).ravel()
    if problem.photo_poses is not None:
        poses = network.photo_rotations, network.photo_positions_m
        _add_poses((normals.photos, normals.photo_gradient), problem.photo_poses, *poses)
    if problem.target_poses is not None:
        poses = network.target_rotations, network.target_positions_m
        _add_poses((normals.targets, normals.target_gradient), problem.target_poses, *poses)
    if problem.points is not None:
        _add_points(normals, problem, network)


def _add_poses(blocks: tuple[Array, Array], known: PoseEquations, rotations: Array, positions_m: Array) -> None:
    residuals = known.residuals(rotations, positions_m)
    jacobian = known.jacobian(residuals)
    weighted = np.swapaxes(jacobian, -1, -2) @ known.information
    _add_at(blocks[0], known.index, weighted @ jacobian)
    _add_at(blocks[1], known.index, (weighted @ residuals[..., None])[..., 0])


def _add_points(normals: NormalEquations, problem: BundleProblem, network: Network) -> None:
    points = problem.points
    assert points is not None
    rows = np.concatenate([points.jacobian(network), points.residuals(network)[..., None]], axis=-1)
    products = np.swapaxes(rows, -1, -2) @ rows
    _add_at(normals.targets, points.target, products[:, :POSE_COUNT, :POSE_COUNT])
    _add_at(normals.target_gradient, points.target, products[:, :POSE_COUNT, -1])
    for point, target in enumerate(points.target):
        printed = problem.print_columns(int(problem.prints.batch[target]))
        normals.target_border[target, :, printed] += products[point, :POSE_COUNT, PRINT_COLUMNS]
        normals.border[printed, printed] += products[point, PRINT_COLUMNS, PRINT_COLUMNS]
        normals.border_gradient[printed] += products[point, PRINT_COLUMNS, -1]
