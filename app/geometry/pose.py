"""A pose: where a camera or a target stands in another frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import exp_rotation, quaternion_xyzw, rotation_of_quaternion

Array = npt.NDArray[np.float64]


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
        if not (np.isfinite(self.rotation).all() and np.isfinite(self.position_m).all()):
            raise ValueError("a pose takes finite numbers")
        if np.abs(self.rotation @ self.rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(self.rotation) < 0:
            raise ValueError("rotation must be proper (orthonormal, determinant 1)")

    @classmethod
    def from_quaternion(cls, orientation_xyzw: Array, position_m: Array) -> Pose:
        """Pose of a quaternion x, y, z, w and a position in metres."""
        return cls(rotation_of_quaternion(np.asarray(orientation_xyzw)), np.asarray(position_m, dtype=np.float64))

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
