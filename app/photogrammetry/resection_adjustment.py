"""Least squares of one photograph: six unknowns of pose and nine weighted unknowns of the camera."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.resection_equations import (
    POSE_COUNT,
    POSITION,
    ROTATION,
    STATE_COUNT,
    CameraPrior,
    State,
    TargetEquations,
    linearise,
)
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class AdjustmentOptions:
    """How the adjustment iterates.

    Attributes
    ----------
    max_steps : int
        Steps after which it counts as not converged; good starts take 2 to 5, an unlikely camera 20.
    converged_sigmas : float
        The last step is shorter than this many standard deviations of the state. It is still taken, which leaves an
        error of its square; what is reported beside the state is as of before it.
    camera_freed : float
        The camera is freed once a step of the pose alone promises to lower the sum of squares by less than this
        fraction of it (or by less than 1): from a poor pose the camera's unknowns would run away.
    max_camera_sigmas : float
        Longest step of the camera's unknowns: within three standard deviations it is what its prior says it is.
    max_shift : float
        Longest step of the position, as a fraction of the median distance to the targets, and of the rotation, rad.
        Beyond it the equations are not nearly linear; a step to infinity would make all residuals equal.
    first_damping : float
        Damping once a step has made things worse, a fraction of the normal matrix' diagonal; it then follows Nielsen,
        Damping Parameter in Marquardt's Method, 1999, equation 2.9.
    """

    max_steps: int = 30
    converged_sigmas: float = 0.1
    camera_freed: float = 0.01
    max_camera_sigmas: float = 3.0
    max_shift: float = 0.5
    first_damping: float = 1e-3


@dataclass(frozen=True)
class AdjustedState:
    """A state of least squares.

    Attributes
    ----------
    state : State
    equations : TargetEquations
        Of the targets that took part, at the state but for the last small step.
    information : ndarray of shape (15, 15)
        Of the state, the camera's prior included.
    gradient : ndarray of shape (15,)
    chi2 : float
        Sum of squares in units of their covariance, the camera's prior included.
    redundancy : int
        Measured coordinates less the six unknowns of the pose.
    converged : bool
    """

    state: State
    equations: TargetEquations
    information: Array
    gradient: Array
    chi2: float
    redundancy: int
    converged: bool = False

    @property
    def attainable_chi2(self) -> float:
        """What a further step, pose and camera free, promises: less than ``chi2`` where an adjustment stopped early."""
        return self.chi2 - float(self.gradient @ np.linalg.solve(self.information, self.gradient))


@dataclass(frozen=True)
class _Step:
    """A step of the state, shape (15,), and by how much it promises to lower the sum of squares."""

    values: Array
    gain: float


@dataclass(frozen=True)
class _Damping:
    """Marquardt's damping and the factor of its next growth."""

    value: float = 0.0
    growth: float = 2.0

    def after(self, gain_ratio: float, options: AdjustmentOptions) -> _Damping:
        """The damping after a step that gained this much of what it promised."""
        if gain_ratio <= 0:
            return _Damping(max(options.first_damping, self.value * self.growth), self.growth * 2.0)
        shrunk = self.value * max(1.0 / 3.0, 1.0 - (2.0 * gain_ratio - 1.0) ** 3)
        return _Damping(shrunk if shrunk > options.first_damping / 10.0 else 0.0)


def adjust_pose(
    sighted: SightedTargets,
    prior: CameraPrior,
    start: State,
    options: AdjustmentOptions | None = None,
    free_camera: bool = True,
) -> AdjustedState:
    """Adjust to all of the targets (damped Gauss-Newton), the pose alone when the camera is not free."""
    options = options or AdjustmentOptions()
    best, damping, unknowns = evaluate(sighted, prior, start), _Damping(), POSE_COUNT
    for _ in range(options.max_steps):
        whole = _step(best, 0.0, unknowns, options)
        if free_camera and unknowns == POSE_COUNT and whole.gain < max(1.0, options.camera_freed * best.chi2):
            unknowns = STATE_COUNT
            whole = _step(best, 0.0, unknowns, options)
        if (unknowns == STATE_COUNT or not free_camera) and whole.gain < options.converged_sigmas**2:
            return replace(best, state=best.state.moved(whole.values), converged=True)
        step = _step(best, damping.value, unknowns, options) if damping.value else whole
        trial = evaluate(sighted, prior, best.state.moved(step.values))
        if trial.chi2 > best.chi2 and unknowns == STATE_COUNT:
            # Distance and focal length trade along a curved valley: back to its floor, the camera held.
            trial = evaluate(sighted, prior, trial.state.moved(_step(trial, 0.0, POSE_COUNT, options).values))
        # At the optimum rounding, and covariances that depend on the state a little, may cost what a step promises.
        gained = best.chi2 - trial.chi2 + options.converged_sigmas**2
        damping = damping.after(gained / step.gain, options)
        if gained > 0:
            best = trial
    return best


def evaluate(sighted: SightedTargets, prior: CameraPrior, state: State) -> AdjustedState:
    """The sum of squares and its normal equations at a state, without moving it."""
    equations = linearise(sighted, prior, state)
    information, gradient = equations.information.sum(axis=0), equations.gradient.sum(axis=0)
    intrinsic = np.arange(POSE_COUNT, STATE_COUNT)
    information[intrinsic, intrinsic] += 1.0  # the prior's information in whitened intrinsics
    gradient[POSE_COUNT:] += state.whitened
    chi2 = float(equations.chi2.sum() + state.whitened @ state.whitened)
    redundancy = 2 * int(np.count_nonzero(sighted.measured)) - POSE_COUNT
    return AdjustedState(state, equations, information, gradient, chi2, redundancy)


def _step(at: AdjustedState, damping: float, unknowns: int, options: AdjustmentOptions) -> _Step:
    """The damped step of the first unknowns; the others stay."""
    information, gradient = at.information[:unknowns, :unknowns], at.gradient[:unknowns]
    damped = information + damping * np.diag(np.diag(information))
    moved: Array = np.asarray(np.linalg.solve(damped, -gradient), dtype=np.float64)
    moved /= max(1.0, _overreach(moved, at.equations, options))
    values = np.zeros(STATE_COUNT)
    values[:unknowns] = moved
    return _Step(values, float(-2.0 * gradient @ moved - moved @ information @ moved))


def _overreach(moved: Array, equations: TargetEquations, options: AdjustmentOptions) -> float:
    """How many times a step of the first unknowns is as long as it may be."""
    reach_m = options.max_shift * float(np.median(equations.distances_m))
    lengths = (
        np.linalg.norm(moved[POSITION]) / reach_m,
        np.linalg.norm(moved[ROTATION]) / options.max_shift,
        np.linalg.norm(moved[POSE_COUNT:]) / options.max_camera_sigmas,
    )
    return float(max(lengths))
