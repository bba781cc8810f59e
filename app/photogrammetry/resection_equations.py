"""The collinearity equations of one photograph, linearised, with each target's own uncertainty eliminated.

Sensors 2019 (robust visual encoded targets), equations 7, 8 and 17, with two differences: orientation is adjusted by
small rotations (the angles are singular looking along the site's Y), and the dots of a target err together, because the
map knows each target only up to its own covariance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera
from app.geometry.pose import Pose
from app.geometry.rotation import skew
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

POSE_COUNT = 6
POSITION, ROTATION = slice(0, 3), slice(3, POSE_COUNT)
STATE_COUNT = POSE_COUNT + INTRINSIC_COUNT  # position (m), small rotation (rad), intrinsics in their prior's sigmas
OWN_COUNT = 6  # a target's own position and rotation
PIXEL_COUNT = 4  # of the intrinsics, fx, fy, cx and cy are in px
FIELD_LIMIT = 3.0  # tangent of 72 degrees off the axis: beyond it Brown-Conrady describes no lens
RIDGE = float(np.sqrt(np.finfo(np.float64).eps))  # under the accuracy of any normal matrix, above its rounding


@dataclass(frozen=True)
class CameraPrior:
    """A calibrated camera in whitened intrinsics z: ``intrinsics = mean + root @ z`` with z of unit covariance."""

    camera: Camera
    root: Array

    @classmethod
    def of(cls, calibrated: CalibratedCamera) -> CameraPrior:
        """The prior of a calibrated camera.

        Raises
        ------
        ValueError
            When its covariance is not positive semidefinite.
        """
        sigmas = np.sqrt(np.diag(calibrated.covariance))
        variances, axes = np.linalg.eigh(calibrated.covariance / np.outer(sigmas, sigmas))
        if variances.min() < -np.sqrt(np.finfo(np.float64).eps):
            raise ValueError("the covariance of the intrinsics is not positive semidefinite")
        return cls(calibrated.camera, sigmas[:, None] * axes * np.sqrt(np.maximum(variances, 0.0)))

    def camera_at(self, whitened: Array) -> Camera:
        """The camera at whitened intrinsics of shape (9,)."""
        return self.camera.with_intrinsics(self.camera.intrinsics + self.root @ whitened)

    def image_plane_change(self, whitened: Array) -> float:
        """Greatest change of an intrinsic by a step of shape (9,), in units of the image plane (focal lengths)."""
        change = np.abs(self.root @ whitened)
        change[:PIXEL_COUNT] /= self.camera.fx_px
        return float(change.max())


@dataclass(frozen=True)
class State:
    """Where an adjustment stands: the pose and the whitened intrinsics of shape (9,)."""

    site_from_cam: Pose
    whitened: Array

    def moved(self, step: Array) -> State:
        """The state after a step of shape (15,)."""
        return State(self.site_from_cam.moved(step[:POSE_COUNT]), self.whitened + step[POSE_COUNT:])


@dataclass(frozen=True)
class TargetEquations:
    """Linearised equations of K targets at a state; residual = computed - observed.

    Attributes
    ----------
    gram : ndarray of shape (K, 16, 16)
        Products of the whitened columns: the target's own movement 6, intrinsics 9, residual 1.
    information : ndarray of shape (K, 15, 15)
        Of the state, per target, its own uncertainty eliminated.
    gradient : ndarray of shape (K, 15)
    chi2 : ndarray of shape (K,)
        Squared residuals in units of their covariance (dots and own uncertainty).
    residuals_px : ndarray of shape (K, 16, 2)
        Zero where not measured.
    distances_m : ndarray of shape (K,)
        From the camera to the targets' centres.
    seen_from_front : ndarray of shape (K,), bool
        Whether the target's measured dots are before the camera and the camera before the target.
    """

    gram: Array
    information: Array
    gradient: Array
    chi2: Array
    residuals_px: Array
    distances_m: Array
    seen_from_front: Mask

    def advanced(self, step: Array, residuals_px: Array) -> TargetEquations:
        """The equations after a step of shape (15,) along which they are linear, with the residuals found there."""
        moved = self.information @ step
        return replace(
            self,
            gradient=self.gradient + moved,
            chi2=np.maximum(self.chi2 + (2.0 * self.gradient + moved) @ step, 0.0),
            residuals_px=residuals_px,
        )

    @cached_property
    def shape_chi2(self) -> Array:
        """The part of ``chi2`` that no rigid movement of the target explains, shape (K,): no pose changes it."""
        normal, right = self.gram[:, :OWN_COUNT, :OWN_COUNT], self.gram[:, :OWN_COUNT, -1:]
        diagonal = np.einsum("kii->ki", normal)
        scale = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))[..., None]
        # Few dots leave movements free; the ridge silences those (their right side is zero) and no other.
        scaled = normal / (scale * np.swapaxes(scale, 1, 2)) + RIDGE * np.eye(OWN_COUNT)
        explained = (np.linalg.solve(scaled, right / scale) * right / scale).sum(axis=(1, 2))
        return np.maximum(self.gram[:, -1, -1] - explained, 0.0)


def linearise(sighted: SightedTargets, prior: CameraPrior, state: State) -> TargetEquations:
    """The collinearity equations of all targets at a state."""
    rotation, position_m = state.site_from_cam.rotation, state.site_from_cam.position_m
    to_centres_m = sighted.centres_m - position_m
    cam_m = (to_centres_m[:, None] + sighted.arms_m) @ rotation
    outside = cam_m[..., 2] <= np.abs(cam_m[..., :2]).max(axis=-1) / FIELD_LIMIT
    if outside.any():
        cam_m[outside] = (0.0, 0.0, 1.0)  # has no image; its target is marked below
    image_px, by_point, by_intrinsics = prior.camera_at(state.whitened).project_with_jacobians(cam_m)
    residuals_px = (image_px - sighted.observed_px) * sighted.measured[..., None]
    columns = np.empty((OWN_COUNT + INTRINSIC_COUNT + 1, *residuals_px.shape))  # component first: long inner loops
    by_point_flat, by_intrinsics_flat = by_point.reshape(-1, 3), by_intrinsics.reshape(-1, INTRINSIC_COUNT)
    columns[:3] = (rotation @ by_point_flat.T).reshape(3, *residuals_px.shape)
    columns[OWN_COUNT:-1] = (prior.root.T @ by_intrinsics_flat.T).reshape(INTRINSIC_COUNT, *residuals_px.shape)
    columns[-1] = residuals_px
    gram = _gram(columns, sighted)
    facing = (sighted.rotations[..., 2] * to_centres_m).sum(axis=-1) < 0
    seen_from_front = ~(outside & sighted.measured).any(axis=-1) & facing
    reduced = _eliminated(gram, sighted.own_covariances, to_centres_m)
    return TargetEquations(
        gram=gram,
        information=reduced[:, :STATE_COUNT, :STATE_COUNT],
        gradient=reduced[:, :STATE_COUNT, -1],
        chi2=reduced[:, -1, -1],
        residuals_px=residuals_px,
        distances_m=np.linalg.norm(to_centres_m, axis=-1),
        seen_from_front=seen_from_front,
    )


def residuals_of(sighted: SightedTargets, prior: CameraPrior, state: State) -> Array:
    """Residuals at a state, px, shape (K, 16, 2): zero where not measured, or where a dot has no image."""
    pose = state.site_from_cam
    cam_m = (sighted.dots_m - pose.position_m) @ pose.rotation
    inside = cam_m[..., 2] > np.abs(cam_m[..., :2]).max(axis=-1) / FIELD_LIMIT
    cam_m[~inside] = (0.0, 0.0, 1.0)
    residuals_px = prior.camera_at(state.whitened).project(cam_m) - sighted.observed_px
    return residuals_px * (inside & sighted.measured)[..., None]


def _gram(columns: Array, sighted: SightedTargets) -> Array:
    """Gram matrices, shape (K, 16, 16), of columns (16, K, 16, 2) that lack the whitening and the own rotations.

    A target's own movement ``translation + rotation x arm`` moves the image by ``d`` and ``arm x d``, where d is the
    image's derivative by the dot.
    """
    w00, w10, w11 = np.moveaxis(sighted.whiteners, -1, 0)
    for part in (columns[:3], columns[OWN_COUNT:]):
        part[..., 1] *= w11
        part[..., 1] += w10 * part[..., 0]
        part[..., 0] *= w00
    x, y, z = columns[:3]
    arm_x, arm_y, arm_z = np.moveaxis(sighted.arms_m[:, :, None], -1, 0)
    columns[3] = arm_y * z - arm_z * y
    columns[4] = arm_z * x - arm_x * z
    columns[5] = arm_x * y - arm_y * x
    rows = np.swapaxes(columns.reshape(*columns.shape[:2], -1), 0, 1)
    return np.asarray(rows @ np.swapaxes(rows, 1, 2))


def _eliminated(gram: Array, own_covariances: Array, to_centres_m: Array) -> Array:
    """Products (K, 16, 16) of pose, intrinsics and residual: own unknowns out (Schur complement), the pose in."""
    own = gram[:, :OWN_COUNT]
    # (Q^-1 + N)^-1 without inverting Q, which is zero for a perfect map.
    gain = np.linalg.solve(np.eye(OWN_COUNT) + own_covariances @ own[:, :, :OWN_COUNT], own_covariances)
    reduced = gram - np.swapaxes(own, 1, 2) @ (gain @ own)
    own_from_pose = np.zeros((len(gram), OWN_COUNT, POSE_COUNT))
    diagonal = np.arange(OWN_COUNT)
    own_from_pose[:, diagonal, diagonal] = -1.0  # the camera's movement is the target's movement the other way
    own_from_pose[:, :3, 3:] = skew(to_centres_m)
    reduced[:, :OWN_COUNT] = np.swapaxes(own_from_pose, 1, 2) @ reduced[:, :OWN_COUNT]
    reduced[:, :, :OWN_COUNT] = reduced[:, :, :OWN_COUNT] @ own_from_pose
    return np.asarray(reduced)
