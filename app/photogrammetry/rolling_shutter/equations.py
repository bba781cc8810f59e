"""Collinearity equations of a camera that moves while it is read: each dot is seen from where the camera was then.

The unknowns of a still photograph, pose and whitened intrinsics, and six of the movement. A target's own uncertainty
and the errors that its dots share are weighed as in a resection of a still photograph.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.rotation import exp_rotation
from app.photogrammetry.resection_equations import OWN_COUNT, POSE_COUNT, STATE_COUNT, CameraPrior, State
from app.photogrammetry.resection_input import SightedTargets
from app.photogrammetry.rolling_shutter.motion import MOTION_COUNT
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]

MOVING_COUNT = STATE_COUNT + MOTION_COUNT
MOTION = slice(STATE_COUNT, MOVING_COUNT)


@dataclass(frozen=True)
class Moving:
    """Where an adjustment stands: pose and camera at the middle of the picture, and the movement, shape (6,)."""

    state: State
    motion: Array

    def moved(self, step: Array) -> Moving:
        """After a step of shape (21,)."""
        return Moving(self.state.moved(step[:STATE_COUNT]), self.motion + step[MOTION])


@dataclass(frozen=True)
class Rows:
    """Equations of all dots, in pixels: derivatives by the target's own movement and by the 21 unknowns; images."""

    own: Array  # (K, 16, 2, 6)
    unknowns: Array  # (K, 16, 2, 21)
    computed_px: Array  # (K, 16, 2)


def moving_rows(sighted: SightedTargets, prior: CameraPrior, at: Moving, times_s: Array) -> Rows:
    """Equations at a state; times of the dots' exposure of shape (K, 16), relative to the middle of the picture."""
    pose = at.state.site_from_cam
    rotation_then = exp_rotation(times_s[..., None] * at.motion[3:]) @ pose.rotation
    from_cam_m = sighted.dots_m - pose.position_m - times_s[..., None] * at.motion[:3]
    cam_m = (np.swapaxes(rotation_then, -1, -2) @ from_cam_m[..., None])[..., 0]
    computed_px, by_cam, by_intrinsics = prior.camera_at(at.state.whitened).project_with_jacobians(cam_m)
    by_site = by_cam @ np.swapaxes(rotation_then, -1, -2)
    # a . (dtheta x arm) = dtheta . (arm x a)
    own = np.concatenate([by_site, np.cross(sighted.arms_m[:, :, None], by_site)], axis=-1)
    by_pose = -np.concatenate([by_site, np.cross(from_cam_m[:, :, None], by_site)], axis=-1)
    unknowns = np.concatenate([by_pose, by_intrinsics @ prior.root, times_s[..., None, None] * by_pose], axis=-1)
    return Rows(own, unknowns, computed_px)


def normal_equations(sighted: SightedTargets, rows: Rows, at: Moving, motion_sigmas: Array) -> tuple[Array, Array]:
    """Information (21, 21) and gradient (21,) of all targets and of what is known of camera and movement."""
    residuals_px = np.where(sighted.measured[..., None], rows.computed_px - sighted.observed_px, 0.0)
    columns = np.concatenate([rows.own, rows.unknowns, residuals_px[..., None]], axis=-1)
    whitened = _whitened(sighted, columns)
    products = np.swapaxes(whitened, -1, -2) @ whitened
    own = products[:, :OWN_COUNT, :OWN_COUNT] + np.linalg.inv(sighted.own_covariances)
    across, rest = products[:, :OWN_COUNT, OWN_COUNT:], products[:, OWN_COUNT:, OWN_COUNT:]
    reduced = (rest - np.swapaxes(across, -1, -2) @ np.linalg.solve(own, across)).sum(axis=0)
    information, gradient = reduced[:MOVING_COUNT, :MOVING_COUNT].copy(), reduced[:MOVING_COUNT, -1].copy()
    known = np.concatenate([np.zeros(POSE_COUNT), np.ones(STATE_COUNT - POSE_COUNT), motion_sigmas**-2.0])
    values = np.concatenate([np.zeros(POSE_COUNT), at.state.whitened, at.motion])
    information[np.arange(MOVING_COUNT), np.arange(MOVING_COUNT)] += known
    return information, gradient + known * values


def _whitened(sighted: SightedTargets, columns_px: Array) -> Array:
    """Columns (K, 16, 2, n), px, in standard deviations and uncorrelated, shape (K, 32, n)."""
    first, across, second = (sighted.whiteners[..., part, None] for part in range(3))
    x, y = columns_px[..., 0, :], columns_px[..., 1, :]
    flat = np.stack([first * x, across * x + second * y], axis=-2).reshape(len(sighted), 2 * DOT_COUNT, -1)
    shift, linear, dots = (sighted.plate_sigmas[:, part, None, None] for part in range(3))
    of_modes = np.concatenate([np.repeat(shift, 2, axis=1), np.repeat(linear, 4, axis=1)], axis=1)
    in_modes = (1.0 / of_modes - 1.0 / dots) * (sighted.modes @ flat)
    return np.asarray(flat / dots + np.swapaxes(sighted.modes, -1, -2) @ in_modes)
