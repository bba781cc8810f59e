"""Pose of one flat target from its dots: both planar solutions, refined, for all targets of a photograph at once.

A small plane looks the same when it is tilted to the one or to the other side of the line of sight, so one target has
two poses. Which of the two is right is decided by the caller, who knows more than one target.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.kernels.planar_poses import pose_targets

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
        The refinement ends when the squared error can fall by no more than this fraction.
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

    @property
    def least(self) -> tuple[float, float]:
        """What dots must have, as compiled loops take it."""
        return float(self.min_dots), self.min_spread

    @property
    def refinement(self) -> tuple[int, float, float, float, float]:
        """How poses are refined, as compiled loops take it."""
        return self.refinement_steps, self.first_damping, self.damping_factor, self.converged, self.floor


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
    count = len(normalised)
    dots = (_own(np.broadcast_to(plane_m, normalised.shape)), _own(normalised), _own(measured))
    rotations = np.tile(np.eye(3), (count, 2, 1, 1))
    translations_m, rms = np.zeros((count, 2, 3)), np.full((count, 2), np.inf)
    pose_targets(dots, options.least, options.refinement, (rotations, translations_m, rms))
    return PlanarPoses(rotations, translations_m, rms)


def _own(values: Array | Mask) -> Array:
    """A copy as compiled loops take it: views of one plate for all targets are neither contiguous nor writable."""
    return np.array(values, dtype=np.float64, order="C")
