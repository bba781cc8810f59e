"""Weighted equations beside the photographs: what is known in advance of poses, points, cameras and the print."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import log_rotation, skew
from app.photogrammetry.network import POSE_COUNT, Network

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class PoseEquations:
    """Poses that are known with an uncertainty: of a photograph that holds the free network, of targets of a map.

    Attributes
    ----------
    index : ndarray of shape (K,)
        Which photograph or target.
    rotations, positions_m : ndarray of shape (K, 3, 3), (K, 3)
        ``frame_from_cam`` or ``frame_from_target``.
    information : ndarray of shape (K, 6, 6)
        Inverse covariance: position (m), small rotation (rad), frame axes.
    """

    index: Index
    rotations: Array
    positions_m: Array
    information: Array

    def residuals(self, rotations: Array, positions_m: Array) -> Array:
        """Present minus known pose, shape (K, 6), of all present poses of that kind."""
        turned_rad = log_rotation(rotations[self.index] @ np.swapaxes(self.rotations, -1, -2))
        return np.concatenate([positions_m[self.index] - self.positions_m, turned_rad], axis=-1)

    def jacobian(self, residuals: Array) -> Array:
        """Derivative of the residuals by the pose's small step, shape (K, 6, 6).

        The rotation's part is the inverse left Jacobian of SO(3) to the third order of the residual, which is small.
        """
        turn = skew(residuals[:, 3:])
        jacobian = np.tile(np.eye(POSE_COUNT), (len(residuals), 1, 1))
        jacobian[:, 3:, 3:] += -turn / 2.0 + turn @ turn / 12.0
        return jacobian


@dataclass(frozen=True)
class PointEquations:
    """Points of plates with known coordinates: the control points.

    Attributes
    ----------
    target : ndarray of shape (K,)
    plane_m : ndarray of shape (K, 2)
        The point in its target's plane, nominal.
    position_m : ndarray of shape (K, 3)
        Its known place in the frame.
    sigma_m : ndarray of shape (K,)
        Standard deviation of each coordinate.
    """

    target: Index
    plane_m: Array
    position_m: Array
    sigma_m: Array

    def __len__(self) -> int:
        return len(self.target)

    def select(self, chosen: npt.NDArray[np.bool_] | Index) -> PointEquations:
        """Some of the points, by mask or by index."""
        return PointEquations(self.target[chosen], self.plane_m[chosen], self.position_m[chosen], self.sigma_m[chosen])

    def arms_m(self, network: Network) -> Array:
        """The points from their target's centre, shape (K, 3), frame axes, print scale included."""
        plate_axes = network.target_rotations[self.target][..., :2]
        return np.asarray((plate_axes @ (self.plane_m * network.print_scale[self.target])[..., None])[..., 0])

    def computed_m(self, network: Network) -> Array:
        """Where the network puts the points, shape (K, 3)."""
        return network.target_positions_m[self.target] + self.arms_m(network)

    def residuals(self, network: Network) -> Array:
        """Computed minus known, shape (K, 3), in standard deviations."""
        return (self.computed_m(network) - self.position_m) / self.sigma_m[:, None]

    def jacobian(self, network: Network) -> Array:
        """Derivative of the residuals by the target's step and the print scale, shape (K, 3, 8)."""
        plate_axes = network.target_rotations[self.target][..., :2]
        jacobian = np.empty((len(self), 3, POSE_COUNT + 2))
        jacobian[..., :3] = np.eye(3)
        jacobian[..., 3:POSE_COUNT] = -skew(self.arms_m(network))
        jacobian[..., POSE_COUNT:] = plate_axes * self.plane_m[:, None]
        return jacobian / self.sigma_m[:, None, None]
