"""The errors of an estimate against the reference, pair by pair."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import log_rotation
from app.trajectories.association import Pairs
from app.trajectories.trajectory import Array


@dataclass(frozen=True)
class Errors:
    """Estimate - reference of K pairs, both in the site frame.

    Attributes
    ----------
    times_s : ndarray of shape (K,)
    vectors_m : ndarray of shape (K, 3)
    rotations_rad : ndarray of shape (K, 3) or None
        Rotation vectors of ``R_estimate R_reference^T``; None when either has no orientations.
    reference_covariances_m2 : ndarray of shape (K, 3, 3) or None
        Of the reference's positions.
    """

    times_s: Array
    vectors_m: Array
    rotations_rad: Array | None
    reference_covariances_m2: Array | None

    def __len__(self) -> int:
        return len(self.times_s)

    @property
    def horizontal_m(self) -> Array:
        """Lengths in the plan, shape (K,)."""
        return np.linalg.norm(self.vectors_m[:, :2], axis=1)

    @property
    def vertical_m(self) -> Array:
        """Absolute differences of height, shape (K,)."""
        return np.abs(self.vectors_m[:, 2])

    @property
    def spatial_m(self) -> Array:
        """Lengths in space, shape (K,)."""
        return np.linalg.norm(self.vectors_m, axis=1)

    @property
    def angles_rad(self) -> Array | None:
        """Angles of the rotations, shape (K,)."""
        return None if self.rotations_rad is None else np.linalg.norm(self.rotations_rad, axis=1)

    def take(self, rows: npt.NDArray[np.bool_] | npt.NDArray[np.intp]) -> Errors:
        """The errors of some pairs."""
        rotations, covariances = self.rotations_rad, self.reference_covariances_m2
        return Errors(
            self.times_s[rows],
            self.vectors_m[rows],
            None if rotations is None else rotations[rows],
            None if covariances is None else covariances[rows],
        )


def errors_of(pairs: Pairs) -> Errors:
    """The errors of pairs whose estimate is aligned."""
    reference, estimate = pairs.reference, pairs.estimate
    turned, true = estimate.rotations, reference.rotations
    rotations_rad = None if turned is None or true is None else log_rotation(turned @ true.transpose(0, 2, 1))
    vectors_m = estimate.positions_m - reference.positions_m
    return Errors(reference.times_s, vectors_m, rotations_rad, reference.position_covariances_m2)
