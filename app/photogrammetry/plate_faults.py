"""Plates that are not as printed: of another size, or bent. Each is fitted with five unknowns more than its pose.

In the plate's plane: a stretch along x and along y. Out of it: the three second-order terms x^2, xy, y^2 of a bend.
Photographs and cameras are held; one linear step from the adjusted network suffices, since faults are small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import PRINT_COLUMNS, linearise
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.prints import PRINT_COUNT
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]

BEND_COUNT = 3
FAULT_COUNT = PRINT_COUNT + BEND_COUNT
UNSEEN_SHARE = 1e-9  # of the strongest direction's information: rounding gives 1e-16, the weakest bend that shows 3e-3


@dataclass(frozen=True)
class PlateFits:
    """What five more unknowns say of each of T plates.

    Attributes
    ----------
    stretch : ndarray of shape (T, 2)
        Along x and y, relative to the other plates.
    stretch_covariance : ndarray of shape (T, 2, 2)
        Of both, as the dots' covariances promise.
    bend_m : ndarray of shape (T,)
        Root mean square of the dots' heights over their best plane.
    displacement_m : ndarray of shape (T,)
        Root mean square by which the faults move the dots, stretch and bend together.
    gain : ndarray of shape (T,)
        Fall of the weighted squares, in variances; chance makes it about 5.
    """

    stretch: Array
    stretch_covariance: Array
    bend_m: Array
    displacement_m: Array
    gain: Array


def fit_plates(problem: BundleProblem, network: Network, loss: RobustLoss) -> PlateFits:
    """Fit the faults of every plate; each needs a sighting."""
    count = POSE_COUNT + FAULT_COUNT
    normals = np.zeros((problem.sightings.target_count, count + 1, count + 1))
    shapes = _bend_shapes(problem.plane_m)
    for camera, chunk in problem.chunks():
        part = problem.sightings.select(chunk)
        equations = linearise(network, part, problem.camera_at(network, camera), problem.plane_m)
        normal_axes = network.target_rotations[part.target][:, None, None, :, 2:]
        out_of_plane = equations.jacobian[..., None, :3] @ normal_axes
        rows = np.concatenate(
            [
                equations.jacobian[..., :POSE_COUNT],
                equations.jacobian[..., PRINT_COLUMNS],
                out_of_plane[..., 0] * shapes[:, None],
                equations.residuals[..., None],
            ],
            axis=-1,
        )
        weight = loss.weight((equations.residuals**2).sum(axis=-1))
        rows = (rows * np.sqrt(weight)[..., None, None]).reshape(len(part), -1, count + 1)
        np.add.at(normals, part.target, np.swapaxes(rows, -1, -2) @ rows)
    return _solved(normals, problem.plane_m, shapes)


def _bend_shapes(plane_m: Array) -> Array:
    """Heights of the sixteen dots for unit bends, shape (16, 3), scaled to plate size and free of pose."""
    x, y = (plane_m / np.abs(plane_m).max()).T
    shapes = np.stack([x * x, x * y, y * y], axis=-1)
    return np.asarray(shapes - shapes.mean(axis=0))


def _least_inverse(normals: Array) -> Array:
    """Inverses, shape (T, k, k), whose solutions leave at zero what the dots do not show.

    The five base dots lie on the plate's diagonals, where x^2 and y^2 are one: a plate of which nothing else was ever
    measured hides half of its bends.
    """
    scale = 1.0 / np.sqrt(np.einsum("tii->ti", normals))[..., None]
    scaled = scale * normals * np.swapaxes(scale, -1, -2)
    return np.asarray(scale * np.linalg.pinv(scaled, rcond=UNSEEN_SHARE, hermitian=True) * np.swapaxes(scale, -1, -2))


def _solved(normals: Array, plane_m: Array, shapes: Array) -> PlateFits:
    printed = slice(POSE_COUNT, POSE_COUNT + PRINT_COUNT)
    pose, every = slice(0, POSE_COUNT), slice(0, POSE_COUNT + FAULT_COUNT)
    right = normals[:, every, -1:]
    inverse = _least_inverse(normals[:, every, every])
    step = -inverse @ right
    with_faults = -(right * step).sum(axis=(1, 2))
    pose_step = -np.linalg.solve(normals[:, pose, pose], right[:, pose])
    without = -(right[:, pose] * pose_step).sum(axis=(1, 2))
    stretch, bend = step[:, printed, 0], step[:, POSE_COUNT + PRINT_COUNT :, 0]
    stretch = stretch - np.median(stretch, axis=0)  # what all plates share is the print scale, not a fault
    bend_m = np.sqrt(((bend @ shapes.T) ** 2).mean(axis=-1))
    stretch_m2 = ((stretch[:, None] * plane_m) ** 2).sum(axis=-1).mean(axis=-1)
    covariance = inverse[:, printed, printed]
    return PlateFits(stretch, covariance, bend_m, np.sqrt(stretch_m2 + bend_m**2), with_faults - without)
