"""The collinearity equations of one photograph, linearised, with each target's own uncertainty eliminated.

Sensors 2019 (robust visual encoded targets), equations 7, 8 and 17, with two differences: orientation is adjusted by
small rotations (the angles are singular looking along the site's Y), and the dots of a target err together, because the
map knows each target only up to its own covariance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera
from app.geometry.pose import Pose
from app.photogrammetry.kernels.descent import LEAST_FOCAL_SHARE, move_state
from app.photogrammetry.kernels.layout import COLUMNS
from app.photogrammetry.kernels.leftovers import explain_by_movement, measure_residuals
from app.photogrammetry.kernels.products import linearise_targets
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

POSE_COUNT = 6
POSITION, ROTATION = slice(0, 3), slice(3, POSE_COUNT)
STATE_COUNT = POSE_COUNT + INTRINSIC_COUNT  # position (m), small rotation (rad), intrinsics in their prior's sigmas
OWN_COUNT = 6  # a target's own position and rotation
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
        """The camera at whitened intrinsics of shape (9,); far outside of the prior its focal lengths stay positive."""
        intrinsics = self.camera.intrinsics + self.root @ whitened
        intrinsics[:2] = np.maximum(intrinsics[:2], LEAST_FOCAL_SHARE * self.camera.intrinsics[:2])
        return self.camera.with_intrinsics(intrinsics)

    @property
    def arrays(self) -> tuple[Array, Array]:
        """Mean intrinsics (9,) and root (9, 9) as compiled loops take them."""
        return self.camera.intrinsics.copy(), np.ascontiguousarray(self.root)


@dataclass(frozen=True)
class State:
    """Where an adjustment stands: the pose and the whitened intrinsics of shape (9,)."""

    site_from_cam: Pose
    whitened: Array

    def moved(self, step: Array) -> State:
        """The state after a step of shape (15,)."""
        rotation, position_m, whitened = np.empty((3, 3)), np.empty(3), np.empty(INTRINSIC_COUNT)
        move_state((*self.site_from_cam.arrays, self.whitened), step, (rotation, position_m, whitened))
        return State(Pose(rotation, position_m), whitened)


@dataclass(frozen=True)
class TargetEquations:
    """Linearised equations of K targets at a state; residual = computed - observed.

    Attributes
    ----------
    gram : ndarray of shape (K, 16, 16)
        Products of the whitened columns: the target's own movement 6, intrinsics 9, residual 1.
    reduced : ndarray of shape (K, 16, 16)
        The same with the own movement eliminated and the pose in its place, so that its uncertainty is allowed for.
    seen_from_front : ndarray of shape (K,), bool
        Whether the target's measured dots are before the camera and the camera before the target.
    """

    gram: Array
    reduced: Array
    seen_from_front: Mask

    @classmethod
    def room(cls, count: int) -> TargetEquations:
        """Room for those of some targets, which a compiled loop fills."""
        gram, reduced = np.empty((2, count, COLUMNS, COLUMNS))
        return cls(gram, reduced, np.empty(count, dtype=np.bool_))

    @property
    def arrays(self) -> tuple[Array, Array, Mask]:
        """As compiled loops take them."""
        return self.gram, self.reduced, self.seen_from_front

    @property
    def information(self) -> Array:
        """Of the state, per target, shape (K, 15, 15)."""
        return self.reduced[:, :STATE_COUNT, :STATE_COUNT]

    @property
    def gradient(self) -> Array:
        """Per target, shape (K, 15)."""
        return self.reduced[:, -1, :STATE_COUNT]

    @property
    def chi2(self) -> Array:
        """Squared residuals in units of their covariance (dots and own uncertainty), shape (K,)."""
        return self.reduced[:, -1, -1]

    @cached_property
    def shape_chi2(self) -> Array:
        """The part of ``chi2`` that no rigid movement of the target explains, shape (K,): no pose changes it."""
        explained = np.empty(len(self.gram))
        explain_by_movement(self.gram, RIDGE, explained)
        return np.maximum(self.gram[:, -1, -1] - explained, 0.0)


def linearise(sighted: SightedTargets, prior: CameraPrior, state: State) -> TargetEquations:
    """The collinearity equations of all targets at a state."""
    equations = TargetEquations.room(len(sighted))
    intrinsics, root = prior.camera_at(state.whitened).intrinsics, prior.arrays[1]
    linearise_targets((*state.site_from_cam.arrays, intrinsics, root), sighted.arrays, equations.arrays)
    return equations


def residuals_of(sighted: SightedTargets, prior: CameraPrior, state: State) -> Array:
    """Residuals at a state, px, shape (K, 16, 2): zero where not measured, or where a dot has no image."""
    residuals_px = np.empty(sighted.observed_px.shape)
    place = (*state.site_from_cam.arrays, prior.camera_at(state.whitened).intrinsics)
    seen = (sighted.centres_m, sighted.arms_m, sighted.observed_px, sighted.measured)
    measure_residuals(place, seen, residuals_px)
    return residuals_px
