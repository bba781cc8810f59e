"""Rotations: exponential map, quaternions and the photogrammetric angles.

Matrices act on columns; small rotations act from the left: ``R_true = exp(dtheta) @ R_estimated``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]

# Within this angle of looking along the site's Y axis phi and kappa turn about one axis and are not reported.
ANGLES_SINGULAR_DEG = 1.0


def skew(vector: Array) -> Array:
    """Cross-product matrices, shape (..., 3, 3), of vectors of shape (..., 3): ``skew(a) @ b = a x b``."""
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vector.shape[:-1], 3, 3)


def exp_rotation(rotation_rad: Array) -> Array:
    """Rotation matrices, shape (..., 3, 3), of rotation vectors of shape (..., 3) (Rodrigues)."""
    theta = np.linalg.norm(rotation_rad, axis=-1)[..., None, None]
    cross = skew(rotation_rad)
    small = theta < 1e-6
    safe = np.where(small, 1.0, theta)
    first = np.where(small, 1.0 - theta**2 / 6.0, np.sin(safe) / safe)
    second = np.where(small, 0.5 - theta**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    return np.eye(3) + first * cross + second * (cross @ cross)


def log_rotation(rotation: Array) -> Array:
    """Rotation vectors, shape (..., 3), rad, of rotation matrices of shape (..., 3, 3)."""
    return Rotation.from_matrix(rotation).as_rotvec()


def quaternion_xyzw(rotation: Array) -> Array:
    """Unit quaternion x, y, z, w with w >= 0, shape (4,), of a rotation matrix."""
    return Rotation.from_matrix(rotation).as_quat(canonical=True)


def rotation_of_quaternion(orientation_xyzw: Array) -> Array:
    """Rotation matrix, shape (3, 3), of a quaternion x, y, z, w of any positive length."""
    return Rotation.from_quat(orientation_xyzw).as_matrix()


def photogrammetric_angles_deg(site_from_cam_rotation: Array) -> tuple[float, float, float] | None:
    """Phi, omega, kappa in degrees; None within a degree of the singularity (looking along the site's Y).

    Notes
    -----
    ``R = site_from_cam diag(1, -1, -1) = R_Y(-phi) R_X(omega) R_Z(kappa)`` with rows a, b, c:
    phi = atan2(-a3, c3), omega = asin(-b3), kappa = atan2(b1, b2).
    """
    a, b, c = site_from_cam_rotation @ np.diag([1.0, -1.0, -1.0])
    omega_rad = float(np.arcsin(np.clip(-b[2], -1.0, 1.0)))
    if abs(abs(np.degrees(omega_rad)) - 90.0) < ANGLES_SINGULAR_DEG:
        return None
    phi_rad, kappa_rad = np.arctan2(-a[2], c[2]), np.arctan2(b[0], b[1])
    return float(np.degrees(phi_rad)), float(np.degrees(omega_rad)), float(np.degrees(kappa_rad))


def angle_between_deg(first: Array, second: Array) -> float:
    """Angle of the rotation that takes one rotation matrix to the other, in degrees."""
    return float(np.degrees(np.linalg.norm(log_rotation(first @ second.T))))
