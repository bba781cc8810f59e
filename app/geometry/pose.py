"""A pose: where a camera or a target stands in another frame."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import exp_rotation, quaternion_xyzw, rotation_of_quaternion

Array = npt.NDArray[np.float64]

PROPER_TOLERANCE = 1e-6  # of a rotation's rows: far above rounding, far under what would move a dot by a pixel


@dataclass(frozen=True)
class Pose:
    """A rigid transform ``target_from_source``: ``target = rotation @ source + position_m``.

    Attributes
    ----------
    rotation : ndarray of shape (3, 3)
        Proper rotation.
    position_m : ndarray of shape (3,)
        The source's origin in the target frame: for ``site_from_cam`` the projection centre.
    """

    rotation: Array
    position_m: Array

    def __post_init__(self) -> None:
        if self.rotation.shape != (3, 3) or self.position_m.shape != (3,):
            raise ValueError(f"a pose takes a 3 x 3 rotation and 3 coordinates, got {self.rotation.shape}")
        if not isfinite(np.vdot(self.rotation, self.rotation) + np.vdot(self.position_m, self.position_m)):
            raise ValueError("a pose takes finite numbers")
        if not _is_proper(self.rotation):
            raise ValueError("rotation must be proper (orthonormal, determinant 1)")

    @classmethod
    def from_quaternion(cls, orientation_xyzw: Array, position_m: Array) -> Pose:
        """Pose of a quaternion x, y, z, w and a position in metres."""
        return cls(rotation_of_quaternion(np.asarray(orientation_xyzw)), np.asarray(position_m, dtype=np.float64))

    @property
    def arrays(self) -> tuple[Array, Array]:
        """Rotation and position as compiled loops take them."""
        rotation, position_m = (np.require(part, np.float64, ("C", "W")) for part in (self.rotation, self.position_m))
        return rotation, position_m

    @property
    def orientation_xyzw(self) -> Array:
        """Unit quaternion x, y, z, w with w >= 0, shape (4,)."""
        return quaternion_xyzw(self.rotation)

    def apply(self, source_m: Array) -> Array:
        """Take points of shape (..., 3) from the source to the target frame."""
        return source_m @ self.rotation.T + self.position_m

    def inverse(self) -> Pose:
        """The same relation read the other way: ``source_from_target``."""
        return Pose(self.rotation.T, -self.rotation.T @ self.position_m)

    def compose(self, source_from_other: Pose) -> Pose:
        """``target_from_other = target_from_source.compose(source_from_other)``."""
        return Pose(self.rotation @ source_from_other.rotation, self.apply(source_from_other.position_m))

    def moved(self, step: Array) -> Pose:
        """Pose after a small step (3 m of position, 3 rad of rotation, both in target axes), shape (6,).

        The rotation is projected back on SO(3), so that any number of steps keeps it proper.
        """
        u, _, vt = np.linalg.svd(exp_rotation(step[3:]) @ self.rotation)
        return Pose(u @ vt, self.position_m + step[:3])


def _is_proper(rotation: Array) -> bool:
    """Whether two rows are orthonormal and the third is their cross product: a pose is born often, so by hand."""
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    misses = (
        a * a + b * b + c * c - 1.0,
        d * d + e * e + f * f - 1.0,
        a * d + b * e + c * f,
        b * f - c * e - g,
        c * d - a * f - h,
        a * e - b * d - i,
    )
    return max(misses) < PROPER_TOLERANCE and min(misses) > -PROPER_TOLERANCE
