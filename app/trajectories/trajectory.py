"""A trajectory: poses of one camera over time, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

UNIT_TOLERANCE = 1e-6  # of a quaternion's length; files round to nine digits


@dataclass(frozen=True)
class Trajectory:
    """N poses ``site_from_cam`` in the order of time.

    Attributes
    ----------
    times_s : ndarray of shape (N,)
        UTC, seconds since 1970, never decreasing.
    positions_m : ndarray of shape (N, 3)
        Projection centres in the site frame.
    orientations_xyzw : ndarray of shape (N, 4)
        Unit quaternions of site_from_cam.
    covariances : ndarray of shape (N, 6, 6) or None
        Position (m, site axes), small rotation (rad, site axes); None when the source of the poses told none.
    """

    times_s: Array
    positions_m: Array
    orientations_xyzw: Array
    covariances: Array | None = None

    def __post_init__(self) -> None:
        count = len(self.times_s)
        _check("times_s", self.times_s, (count,))
        _check("positions_m", self.positions_m, (count, 3))
        _check("orientations_xyzw", self.orientations_xyzw, (count, 4))
        if self.covariances is not None:
            _check("covariances", self.covariances, (count, 6, 6))
        if (np.diff(self.times_s) < 0).any():
            raise ValueError("times_s must not decrease; sort the poses by time")
        if (np.abs(np.linalg.norm(self.orientations_xyzw, axis=1) - 1.0) > UNIT_TOLERANCE).any():
            raise ValueError("orientations_xyzw takes unit quaternions")

    def __len__(self) -> int:
        return len(self.times_s)

    @property
    def sigmas(self) -> Array | None:
        """Standard deviations of position (m) and small rotation (rad), shape (N, 6); None without covariances."""
        return None if self.covariances is None else np.sqrt(np.diagonal(self.covariances, axis1=1, axis2=2))


def _check(name: str, array: Array, shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise ValueError(f"{name} of {shape[0]} poses takes the shape {shape}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} takes finite numbers")
