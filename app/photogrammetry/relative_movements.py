"""The targets of one snapshot held against each other: each one's movement against the pose that the others give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import skew
from app.photogrammetry.evidence import SnapshotEvidence
from app.photogrammetry.resection_equations import OWN_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

TRANSLATION = slice(0, 3)


@dataclass(frozen=True)
class RelativeMovements:
    """Movements of K targets of one snapshot against the others.

    Attributes
    ----------
    displacements_m : ndarray of shape (K, 3)
        Of the targets' centres, site axes.
    covariances_m2 : ndarray of shape (K, 3, 3)
        By the dots of the target and of the others, and by the others' own uncertainty in the map; not by the
        target's own, which is the same in every snapshot.
    others : ndarray of shape (K,), int
        How many targets the pose then hangs on; with less than are asked for nothing is said (NaN).
    """

    displacements_m: Array
    covariances_m2: Array
    others: npt.NDArray[np.int64]


def hold_against_others(
    evidence: SnapshotEvidence, centres_m: Array, own_covariances: Array, trusted: Mask, fewest_others: int
) -> RelativeMovements:
    """Movement of each target against the pose that the trusted others give.

    Parameters
    ----------
    evidence : SnapshotEvidence
        Of K targets.
    centres_m : ndarray of shape (K, 3)
        Where the map has the targets.
    own_covariances : ndarray of shape (K, 6, 6)
        Each target's own uncertainty in the map.
    trusted : ndarray of shape (K,), bool
        Which targets the pose may hang on.
    fewest_others : int
        With fewer, what moved cannot be told from what did not.

    Notes
    -----
    A step p of the camera's pose, position (m) and small rotation (rad) in site axes, moves a target at c from the
    camera by T p with T = [[-1, [c]x], [0, -1]]. With apparent movements u of information N, own covariances Q and
    weights W = (N^-1 + Q)^-1 the pose's correction is the p that minimises the sum of (u - T p)^T W (u - T p): least
    squares with six unknowns, from which a target is taken out by subtracting its part.
    """
    movements = evidence.movements
    steps = camera_steps(centres_m + movements.values[:, TRANSLATION] - evidence.site_from_cam.position_m)
    noise = np.linalg.inv(movements.information)
    weighted = np.swapaxes(steps, -1, -2) @ np.linalg.inv(noise + own_covariances) * trusted[:, None, None]
    normals, rights = weighted @ steps, (weighted @ movements.values[..., None])[..., 0]
    others = np.count_nonzero(trusted) - trusted.astype(np.int64)
    known = others >= fewest_others
    displacements_m, covariances_m2 = np.full((len(movements), 3), np.nan), np.full((len(movements), 3, 3), np.nan)
    if known.any():
        without = np.linalg.inv(normals.sum(axis=0) - normals[known])
        corrections = without @ (rights.sum(axis=0) - rights[known])[..., None]
        moved = movements.values[known] - (steps[known] @ corrections)[..., 0]
        covariance = noise[known] + steps[known] @ without @ np.swapaxes(steps[known], -1, -2)
        displacements_m[known] = moved[:, TRANSLATION]
        covariances_m2[known] = covariance[:, TRANSLATION, TRANSLATION]
    return RelativeMovements(displacements_m, covariances_m2, others)


def camera_steps(to_centres_m: Array) -> Array:
    """How a step of the pose moves targets at these places from the camera, shape (K, 6, 6)."""
    steps = np.zeros((len(to_centres_m), OWN_COUNT, OWN_COUNT))
    steps[:, :3, :3] = steps[:, 3:, 3:] = -np.eye(3)
    steps[:, :3, 3:] = skew(to_centres_m)
    return steps
