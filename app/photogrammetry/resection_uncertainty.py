"""How far a resected pose can be trusted: its covariance, corrected where least squares would flatter it.

Twice it would: when residuals are greater than their covariances say (variance factor), and when a plate is seen so
nearly from the front that its tilt shows only in second order and the sum of squares is flatter than its normal matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri

from app.geometry.camera import CalibratedCamera, CameraSource
from app.photogrammetry.resection_adjustment import AdjustedState, evaluate
from app.photogrammetry.resection_equations import POSE_COUNT, ROTATION, STATE_COUNT, CameraPrior
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class UncertaintyOptions:
    """When the covariance is corrected.

    Attributes
    ----------
    significance : float
        The variance factor counts when chance would exceed it less often than this.
    linear_rad : float
        Standard deviation of a rotation above which the sum of squares is walked: within a tenth of a degree even
        the cosine of a plate's tilt is a straight line.
    walk_sigmas : float
        How far it is walked to either side.
    walk_steps : int
        Adjustments of all else on the way; the second is exact enough.
    """

    significance: float = 0.01
    linear_rad: float = 0.002
    walk_sigmas: float = 5.0
    walk_steps: int = 2


@dataclass(frozen=True)
class PoseUncertainty:
    """Covariance of a pose.

    Attributes
    ----------
    covariance : ndarray of shape (6, 6)
        Position (m) and small rotation (rad), site axes, without the datum.
    variance_factor : float
        What residuals scaled it by, at least 1.
    widening : float
        Greatest factor by which a standard deviation was widened because the sum of squares is flatter than quadratic.
    """

    covariance: Array
    variance_factor: float
    widening: float


@dataclass(frozen=True)
class _Walk:
    """Ways out of the minimum."""

    sighted: SightedTargets
    prior: CameraPrior
    adjusted: AdjustedState
    options: UncertaintyOptions

    def rise(self, step: Array) -> float:
        """By how much the sum of squares rises after a step when all that does not undo the turn is adjusted again."""
        turn = np.zeros(STATE_COUNT)
        turn[ROTATION] = step[ROTATION] / np.linalg.norm(step[ROTATION])
        state, chi2 = self.adjusted.state.moved(step), np.inf
        for _ in range(self.options.walk_steps):
            at = evaluate(self.sighted, self.prior, state)
            correction = _hold(at, turn)
            state, chi2 = state.moved(correction), at.chi2 + float(at.gradient @ correction)
        return chi2 - self.adjusted.chi2


def _hold(at: AdjustedState, turn: Array) -> Array:
    """The step of least squares, shape (15,), that does not turn about an axis: ``turn`` (15,) of unit length."""
    free = np.linalg.svd(turn[None])[2][1:]  # 14 directions perpendicular to it
    return np.asarray(free.T @ np.linalg.solve(free @ at.information @ free.T, -free @ at.gradient))


def pose_uncertainty(
    sighted: SightedTargets, prior: CameraPrior, adjusted: AdjustedState, options: UncertaintyOptions | None = None
) -> PoseUncertainty:
    """Covariance of the pose that was adjusted to all of the targets."""
    options = options or UncertaintyOptions()
    covariance = adjusted.covariance
    widest, widened, walk = 1.0, covariance, _Walk(sighted, prior, adjusted, options)
    variances, axes = np.linalg.eigh(covariance[ROTATION, ROTATION])
    for variance, axis in zip(variances, axes.T, strict=True):
        if variance > options.linear_rad**2:
            one_sigma = covariance[:, ROTATION] @ axis / np.sqrt(variance)
            widening = _widening(walk, one_sigma)
            widest, widened = max(widest, widening), widened + (widening**2 - 1.0) * np.outer(one_sigma, one_sigma)
    factor = variance_factor(sighted, adjusted, options)
    return PoseUncertainty(factor * widened[:POSE_COUNT, :POSE_COUNT], factor, widest)


def posterior_camera(prior: CameraPrior, adjusted: AdjustedState, source: CameraSource) -> CalibratedCamera:
    """The camera after an adjustment: its prior, sharpened by what the photograph's geometry carries."""
    whitened = adjusted.covariance[POSE_COUNT:, POSE_COUNT:]
    covariance = prior.root @ whitened @ prior.root.T
    return CalibratedCamera(prior.camera_at(adjusted.state.whitened), (covariance + covariance.T) / 2.0, source)


def variance_factor(
    sighted: SightedTargets, adjusted: AdjustedState, options: UncertaintyOptions | None = None
) -> float:
    """What to scale the covariance by: 1, or how much residuals exceed their sigmas where that is no chance.

    Looked at twice: over all coordinates, and over the targets' rigid movements alone, which are what moves a pose and
    which a map that is less certain than it says shows in.
    """
    options = options or UncertaintyOptions()
    movements = adjusted.chi2 - float(adjusted.equations.shape_chi2.sum())
    freedom = int(sighted.freedoms.sum()) - POSE_COUNT
    factors = [1.0]
    for chi2, degrees in ((adjusted.chi2, adjusted.redundancy), (movements, freedom)):
        if degrees > 0 and chi2 > chdtri(degrees, options.significance):
            factors.append(chi2 / degrees)
    return max(factors)


def _widening(walk: _Walk, one_sigma: Array) -> float:
    """How much wider than one standard deviation, a step of shape (15,), the sum of squares really is there.

    A step of k standard deviations raises a quadratic sum of squares by k^2. Where it rises less, the standard
    deviation is as much greater as its root is less.
    """
    k = walk.options.walk_sigmas
    rise = min(walk.rise(sign * k * one_sigma) for sign in (-1.0, 1.0))
    return float(k / np.sqrt(np.clip(rise, 1.0, k**2)))
