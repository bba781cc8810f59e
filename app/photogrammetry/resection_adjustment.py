"""Least squares of one photograph: six unknowns of pose and nine weighted unknowns of the camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.kernels.steps import damped_step
from app.photogrammetry.resection_equations import (
    POSE_COUNT,
    POSITION,
    ROTATION,
    STATE_COUNT,
    CameraPrior,
    State,
    TargetEquations,
    linearise,
    residuals_of,
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
        The last step is shorter than this many standard deviations of the state.
    linear_step : float
        Or shorter than this, in rad, in distances to the nearest target and in units of the image plane: what the
        linear equations then leave out is of its square, some thousandths of a pixel. The last step is still taken.
    near_step : float
        The camera is freed once a step of the pose alone is shorter than this (measured as ``linear_step``), or
        promises less than 1: from a poor pose the camera's unknowns would run away.
    max_camera_sigmas : float
        Longest step of the camera's unknowns: within three standard deviations it is what its prior says it is.
    max_shift : float
        Longest step of the position, as a fraction of the (upper) median distance to the targets, and of the rotation,
        rad. Beyond it the equations are not nearly linear; a step to infinity would make all residuals equal.
    first_damping : float
        Damping once a step has made things worse, a fraction of the normal matrix' diagonal; it then follows Nielsen,
        Damping Parameter in Marquardt's Method, 1999, equation 2.9.
    """

    max_steps: int = 30
    converged_sigmas: float = 0.1
    linear_step: float = 2e-3
    near_step: float = 0.01
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
        Of the targets that took part, at the state.
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
    """A step of the state, shape (15,), by how much it promises to lower the sum of squares, and its length.

    The length is the greatest of rotation (rad), shift (distances to the nearest target) and camera (image plane).
    """

    values: Array
    gain: float
    length: float


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


@dataclass(frozen=True)
class _Steps:
    """Computes steps."""

    prior: CameraPrior
    options: AdjustmentOptions

    def step(self, at: AdjustedState, unknowns: int, damping: float = 0.0) -> _Step:
        """The damped step of the first unknowns, no longer than it may be; the other unknowns stay."""
        values, options = np.zeros(STATE_COUNT), self.options
        distances_m = at.equations.distances_m
        middle_m = np.partition(distances_m, len(distances_m) // 2)[len(distances_m) // 2]
        longest = (options.max_shift * float(middle_m), options.max_shift, options.max_camera_sigmas)
        information, gradient = at.information[:unknowns, :unknowns], at.gradient[:unknowns]
        gain = damped_step(information, gradient, damping, longest, values)
        shift = float(np.sqrt(values[POSITION] @ values[POSITION])) / distances_m.min()
        turn_rad = float(np.sqrt(values[ROTATION] @ values[ROTATION]))
        return _Step(values, gain, max(shift, turn_rad, self.prior.image_plane_change(values[POSE_COUNT:])))


def adjust_pose(
    sighted: SightedTargets,
    prior: CameraPrior,
    start: State,
    options: AdjustmentOptions | None = None,
    free_camera: bool = True,
) -> AdjustedState:
    """Adjust to all of the targets (damped Gauss-Newton), the pose alone when the camera is not free."""
    options = options or AdjustmentOptions()
    steps = _Steps(prior, options)
    best, damping, unknowns = evaluate(sighted, prior, start), _Damping(), POSE_COUNT
    for _ in range(options.max_steps):
        whole = steps.step(best, unknowns)
        if free_camera and unknowns == POSE_COUNT and (whole.gain < 1.0 or whole.length < options.near_step):
            unknowns = STATE_COUNT
            whole = steps.step(best, unknowns)
        short = whole.gain < options.converged_sigmas**2 or whole.length < options.linear_step
        if short and (unknowns == STATE_COUNT or not free_camera):
            return _advanced(best, sighted, prior, whole.values)
        step = steps.step(best, unknowns, damping.value) if damping.value else whole
        trial = evaluate(sighted, prior, best.state.moved(step.values))
        if trial.chi2 > best.chi2 and unknowns == STATE_COUNT:
            # Distance and focal length trade along a curved valley: back to its floor, the camera held.
            trial = evaluate(sighted, prior, trial.state.moved(steps.step(trial, POSE_COUNT).values))
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


def _advanced(at: AdjustedState, sighted: SightedTargets, prior: CameraPrior, step: Array) -> AdjustedState:
    """The adjusted state after a last step along which its equations are linear."""
    state = at.state.moved(step)
    return AdjustedState(
        state=state,
        equations=at.equations.advanced(step, residuals_of(sighted, prior, state)),
        information=at.information,
        gradient=at.gradient + at.information @ step,
        chi2=max(at.chi2 + float(2.0 * at.gradient @ step + step @ at.information @ step), 0.0),
        redundancy=at.redundancy,
        converged=True,
    )
