"""Pose of one flat target from its dots: both planar solutions, refined, for all targets of a photograph at once.

A small plane looks the same when it is tilted to the one or to the other side of the line of sight, so one target has
two poses. Which of the two is right is decided by the caller, who knows more than one target.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import exp_rotation
from app.photogrammetry.planar_closed_form import closed_form_poses, weighted_mean

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class PlanarPoseOptions:
    """How planar poses are computed.

    Attributes
    ----------
    min_dots : int
        Fewer measured dots give no pose: six unknowns take three dots, the choice between mirror images a fourth.
    min_spread : float
        Least ratio of the dots' extent across their best line to that along it. Collinear dots have 0; the narrowest
        four dots of a plate that are not collinear have 0.3.
    refinement_steps : int
        Most Levenberg-Marquardt steps on the reprojection error; exact dots end within 4, noisy ones within 8.
    first_damping, damping_factor : float
        Levenberg-Marquardt damping, a fraction of the normal matrix' diagonal, and its change from step to step.
    converged : float
        The refinement ends when no target's squared error can fall by more than this fraction.
    floor : float
        Nor by more than the square of this, in normalised units: rounding, far under any dot's accuracy.
    """

    min_dots: int = 4
    min_spread: float = 0.05
    refinement_steps: int = 10
    first_damping: float = 1e-4
    damping_factor: float = 10.0
    converged: float = 1e-6
    floor: float = 1e-13


@dataclass(frozen=True)
class PlanarPoses:
    """Two poses per target, the better first.

    Attributes
    ----------
    rotations : ndarray of shape (K, 2, 3, 3)
        ``cam_from_target``, proper; the identity where there is no pose.
    translations_m : ndarray of shape (K, 2, 3)
        The target's origin in the camera frame.
    rms : ndarray of shape (K, 2)
        Root mean square reprojection error per coordinate of the measured dots, in normalised image units (times the
        focal length: px). Infinite where there is no pose: too few or collinear dots, or dots behind the camera. When
        both solutions run into one minimum they are equal.
    """

    rotations: Array
    translations_m: Array
    rms: Array

    @property
    def exists(self) -> Mask:
        """Which poses are poses, shape (K, 2)."""
        return np.isfinite(self.rms)


@dataclass(frozen=True)
class _Dots:
    """Dots of K targets: in the target frame (K, 1, N, 3), in the image plane (K, 1, N, 2), weights (K, 1, N)."""

    target_m: Array
    normalised: Array
    weights: Array


@dataclass(frozen=True)
class _Poses:
    """Rotations (K, 2, 3, 3) and translations (K, 2, 3)."""

    rotations: Array
    translations_m: Array


def planar_poses(
    plane_m: Array, normalised: Array, measured: Mask, options: PlanarPoseOptions | None = None
) -> PlanarPoses:
    """Both poses ``cam_from_target`` of each of K flat targets.

    Parameters
    ----------
    plane_m : ndarray of shape (N, 2) or (K, N, 2)
        Dots in the target's plane, target frame, metres.
    normalised : ndarray of shape (K, N, 2)
        Their undistorted image-plane coordinates (``Camera.normalise``); anything finite where not measured.
    measured : ndarray of shape (K, N), bool
        Which dots count.
    options : PlanarPoseOptions, optional

    Returns
    -------
    PlanarPoses
        Best first; a target without a pose carries an infinite rms.
    """
    options = options or PlanarPoseOptions()
    plane_m = np.broadcast_to(plane_m, normalised.shape)
    count = len(normalised)
    rotations = np.tile(np.eye(3), (count, 2, 1, 1))
    translations_m, rms = np.zeros((count, 2, 3)), np.full((count, 2), np.inf)
    usable = np.flatnonzero(_usable(plane_m, normalised, measured, options))
    if usable.size:
        found = _solve(plane_m[usable], normalised[usable], measured[usable].astype(np.float64), options)
        rotations[usable], translations_m[usable], rms[usable] = found.rotations, found.translations_m, found.rms
    return PlanarPoses(rotations, translations_m, rms)


def _usable(plane_m: Array, normalised: Array, measured: Mask, options: PlanarPoseOptions) -> Mask:
    """Which targets have enough measured dots, off one line and not all in one image point, shape (K,)."""
    weights = measured.astype(np.float64)
    enough = weights.sum(axis=-1) >= options.min_dots
    weights[~enough] = 1.0
    least, greatest = _extents(plane_m, weights).T
    off_one_line = least > options.min_spread * greatest
    usable: Mask = enough & off_one_line & (_extents(normalised, weights)[:, 1] > 0)
    return usable


def _extents(points: Array, weights: Array) -> Array:
    """Extents across and along the best line of weighted points (K, N, 2), shape (K, 2)."""
    centred = points - weighted_mean(points, weights)[:, None]
    moments = np.swapaxes(centred * weights[..., None], -1, -2) @ centred
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(moments), 0.0)))


def _solve(plane_m: Array, normalised: Array, weights: Array, options: PlanarPoseOptions) -> PlanarPoses:
    target_m = np.concatenate([plane_m, np.zeros((*plane_m.shape[:-1], 1))], axis=-1)
    dots = _Dots(target_m[:, None], normalised[:, None], weights[:, None])
    poses, squared = _refine(_Poses(*closed_form_poses(plane_m, normalised, weights)), dots, options)
    rms = np.sqrt(squared / (2.0 * dots.weights.sum(axis=-1)))
    order = np.argsort(rms, axis=1)
    target = np.arange(len(rms))[:, None]
    return PlanarPoses(poses.rotations[target, order], poses.translations_m[target, order], rms[target, order])


def _refine(poses: _Poses, dots: _Dots, options: PlanarPoseOptions) -> tuple[_Poses, Array]:
    """Poses of least squared reprojection error, and that error, shape (K, 2)."""
    squared = _squared_error(poses, dots)
    damping = np.full(squared.shape, options.first_damping)
    for _ in range(options.refinement_steps):
        trial, gain = _stepped(poses, dots, damping)
        trial_squared = _squared_error(trial, dots)
        better = trial_squared < squared
        damping = damping * np.where(better, 1.0 / options.damping_factor, options.damping_factor)
        poses = _Poses(
            np.where(better[..., None, None], trial.rotations, poses.rotations),
            np.where(better[..., None], trial.translations_m, poses.translations_m),
        )
        squared = np.where(better, trial_squared, squared)
        if (gain <= options.converged * squared + options.floor**2).all():
            break
    return poses, squared


def _squared_error(poses: _Poses, dots: _Dots) -> Array:
    """Weighted squared reprojection error, shape (K, 2); infinite when a measured dot is not in front."""
    cam_m = dots.target_m @ np.swapaxes(poses.rotations, -1, -2) + poses.translations_m[..., None, :]
    behind = ((cam_m[..., 2] <= 0) & (dots.weights > 0)).any(axis=-1)
    depth_m = np.where(cam_m[..., 2:] > 0, cam_m[..., 2:], 1.0)
    squared = ((cam_m[..., :2] / depth_m - dots.normalised) ** 2).sum(axis=-1)
    return np.where(behind, np.inf, (dots.weights * squared).sum(axis=-1))


def _stepped(poses: _Poses, dots: _Dots, damping: Array) -> tuple[_Poses, Array]:
    """Poses after one damped step (small rotation from the left, camera frame) and its promised gain, shape (K, 2)."""
    turned_m = dots.target_m @ np.swapaxes(poses.rotations, -1, -2)
    cam_m = turned_m + poses.translations_m[..., None, :]
    residuals, jacobian = _linearised(turned_m, cam_m, dots)
    transposed = np.swapaxes(jacobian * np.repeat(dots.weights, 2, axis=-1)[..., None], -1, -2)
    normal = transposed @ jacobian
    diagonal = np.einsum("...ii->...i", normal)
    diagonal *= 1.0 + damping[..., None]
    gradient = transposed @ residuals
    step = -np.asarray(np.linalg.solve(normal, gradient)[..., 0], dtype=np.float64)
    stepped = _Poses(exp_rotation(step[..., 3:]) @ poses.rotations, poses.translations_m + step[..., :3])
    return stepped, -(gradient[..., 0] * step).sum(axis=-1)


def _linearised(turned_m: Array, cam_m: Array, dots: _Dots) -> tuple[Array, Array]:
    """Residuals (K, 2, 2 N, 1) and their derivatives (K, 2, 2 N, 6) by translation and small rotation."""
    inverse_z = 1.0 / np.where(cam_m[..., 2] > 0, cam_m[..., 2], np.inf)
    x, y = cam_m[..., 0] * inverse_z, cam_m[..., 1] * inverse_z
    qx, qy, qz = turned_m[..., 0], turned_m[..., 1], turned_m[..., 2]
    jacobian = np.zeros((*x.shape, 2, 6))
    jacobian[..., 0, 0] = jacobian[..., 1, 1] = 1.0
    jacobian[..., 0, 2], jacobian[..., 1, 2] = -x, -y
    jacobian[..., 0, 3], jacobian[..., 0, 4], jacobian[..., 0, 5] = -x * qy, qz + x * qx, -qy
    jacobian[..., 1, 3], jacobian[..., 1, 4], jacobian[..., 1, 5] = -qz - y * qy, y * qx, qx
    jacobian *= inverse_z[..., None, None]
    residuals = np.stack([x, y], axis=-1) - dots.normalised
    return residuals.reshape(*x.shape[:2], -1, 1), jacobian.reshape(*x.shape[:2], -1, 6)
