"""What an adjustment knows about its own result: covariances of targets, photographs and cameras, from the factor.

Each target's uncertainty is parted in two: what all targets share, a small similarity of the whole map (the datum), and
what is its own. The parting is Baarda's S-transformation to the datum of all targets: the similarity is the one that
fits the errors of all dots best, what it leaves is own.
Sources: Baarda, S-transformations and criterion matrices, 1973; Teunissen, in Grafarend and Sanso (eds.), Optimization
and design of geodetic networks, 1985.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import SurveyFailed
from app.geometry.target_map import Datum
from app.photogrammetry.bundle_normals import normal_equations
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.equations import PointEquations
from app.photogrammetry.inverse_parts import inverse_parts
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.reduced_system import ReducedSystem, Unknowns, photo_graph_tree, reduce_normals
from app.photogrammetry.robust import RobustLoss
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

SIMILARITY_COUNT = 7


@dataclass(frozen=True)
class PoseCovariances:
    """Covariances of the whole adjustment, datum included.

    Attributes
    ----------
    photos, targets : ndarray of shape (P, 6, 6), (T, 6, 6)
        Position (m), small rotation (rad), frame axes.
    border : ndarray of shape (f, f)
        Of the free shared unknowns: nine intrinsics per camera, then the print scale.
    """

    photos: Array
    targets: Array
    border: Array


@dataclass(frozen=True)
class PartedCovariances:
    """Own covariances of targets and photographs, and the datum that they share.

    Attributes
    ----------
    photos, targets : ndarray of shape (P, 6, 6), (T, 6, 6)
        Relative to the datum.
    datum : Datum
    """

    photos: Array
    targets: Array
    datum: Datum


def reduced_at(problem: BundleProblem, network: Network, loss: RobustLoss) -> ReducedSystem:
    """The undamped normal equations at an adjusted network, factored.

    Raises
    ------
    SurveyFailed
        Reason ``weak-network`` when the observations leave something undetermined.
    """
    normals = normal_equations(problem, network, loss)
    try:
        return reduce_normals(normals, problem.sightings, problem.free_border, photo_graph_tree(problem.sightings))
    except np.linalg.LinAlgError as error:
        raise SurveyFailed(
            "The photographs and control points leave part of the network undetermined. Add photographs from other "
            "sides and with more plates in common.",
            reason="weak-network",
        ) from error


def pose_covariances(reduced: ReducedSystem, sightings: Sightings) -> PoseCovariances:
    """Covariances of all poses and shared unknowns."""
    photos = np.empty((sightings.photo_count, POSE_COUNT, POSE_COUNT))
    targets = reduced.target_inverse.copy()
    for front in inverse_parts(reduced, sightings):
        photos[front.photos] = front.photo_covariances
        for part in front.targets:
            targets[part.target] += part.gain @ part.inverse @ part.gain.T
    return PoseCovariances(photos, targets, reduced.factor.border_inverse())


def part_datum(
    covariances: PoseCovariances,
    reduced: ReducedSystem,
    network: Network,
    defining: npt.NDArray[np.bool_],
    plane_m: Array,
) -> PartedCovariances:
    """Part covariances into own and shared.

    Parameters
    ----------
    covariances : PoseCovariances
    reduced : ReducedSystem
    network : Network
    defining : ndarray of shape (T,), bool
        The targets whose dots define the datum: those that are published.
    plane_m : ndarray of shape (16, 2)
        Dots in the target's plane.
    """
    origin_m = network.target_positions_m[defining].mean(axis=0)
    frame = Datum(origin_m, np.zeros((SIMILARITY_COUNT, SIMILARITY_COUNT)))
    design = _following(frame, network.target_positions_m) * defining[:, None, None]
    # A turn of a plate counts by what it moves the plate's dots.
    arm_m2 = float((plane_m**2).sum(axis=-1).mean())
    weighted = design * np.repeat([1.0, arm_m2], 3)[:, None]
    fit = np.linalg.pinv(np.einsum("tij,tik->jk", weighted, design), hermitian=True)
    rows = (weighted @ fit).reshape(-1, SIMILARITY_COUNT)
    with_datum = reduced.solve(_of_targets(reduced, network, rows))
    shared = rows.T @ with_datum.targets
    datum = Datum(origin_m, (shared + shared.T) / 2.0)
    photos = _own(covariances.photos, with_datum.photos, datum, network.photo_positions_m)
    targets = _own(covariances.targets, with_datum.targets, datum, network.target_positions_m)
    return PartedCovariances(photos, targets, datum)


def _own(covariances: Array, with_datum: Array, datum: Datum, positions_m: Array) -> Array:
    """Covariances (n, 6, 6) after the datum's part is taken off; ``with_datum`` (6 n, 7) are covariances with it."""
    follows = _following(datum, positions_m)
    across = with_datum.reshape(-1, POSE_COUNT, SIMILARITY_COUNT) @ np.swapaxes(follows, -1, -2)
    shared = follows @ datum.covariance @ np.swapaxes(follows, -1, -2)
    own = covariances - across - np.swapaxes(across, -1, -2) + shared
    return np.asarray((own + np.swapaxes(own, -1, -2)) / 2.0)


def _following(datum: Datum, positions_m: Array) -> Array:
    """Derivative of poses at positions (n, 3) by the datum's seven parameters, shape (n, 6, 7)."""
    follows = np.zeros((len(positions_m), POSE_COUNT, SIMILARITY_COUNT))
    follows[:, :3] = datum.point_jacobian(positions_m)
    follows[:, 3:, 3:POSE_COUNT] = np.eye(3)
    return follows


def point_covariance(reduced: ReducedSystem, network: Network, points: PointEquations) -> Array:
    """Joint covariance of points on targets, shape (3 K, 3 K), frame axes."""
    jacobian = points.jacobian(network)[..., :POSE_COUNT] * points.sigma_m[:, None, None]  # the points' own, in metres
    targets = np.zeros((len(network.target_rotations), POSE_COUNT, len(points), 3))
    targets[points.target, :, np.arange(len(points))] = np.swapaxes(jacobian, -1, -2)
    rows = targets.reshape(-1, 3 * len(points))
    return np.asarray(rows.T @ reduced.solve(_of_targets(reduced, network, rows)).targets)


def _of_targets(reduced: ReducedSystem, network: Network, targets: Array) -> Unknowns:
    """Right-hand sides (6 T, k) that concern targets alone."""
    columns = targets.shape[1]
    photos = np.zeros((POSE_COUNT * len(network.photo_rotations), columns))
    return Unknowns(photos, targets, np.zeros((len(reduced.factor.border), columns)))
