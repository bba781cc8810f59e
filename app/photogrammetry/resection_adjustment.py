"""Least squares of one photograph: six unknowns of pose and nine weighted unknowns of the camera."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.photogrammetry.kernels.descent import descend, evaluate_place
from app.photogrammetry.resection_equations import POSE_COUNT, STATE_COUNT, CameraPrior, State, TargetEquations
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

    def limits(self, free_camera: bool) -> tuple[int, bool, float, float, float, float, float, float]:
        """As the compiled loop takes them."""
        steps = (self.converged_sigmas, self.linear_step, self.near_step)
        return (self.max_steps, free_camera, *steps, self.max_camera_sigmas, self.max_shift, self.first_damping)


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
    converged: bool

    @property
    def attainable_chi2(self) -> float:
        """What a further step, pose and camera free, promises: less than ``chi2`` where an adjustment stopped early."""
        return self.chi2 - float(self.gradient @ np.linalg.solve(self.information, self.gradient))

    @cached_property
    def covariance(self) -> Array:
        """Of the state, shape (15, 15)."""
        return np.asarray(np.linalg.inv(self.information), dtype=np.float64)


@dataclass(frozen=True)
class _Place:
    """Room for a state, its equations and their sums, as ``kernels/descent.py`` fills it."""

    state: tuple[Array, Array, Array]
    equations: TargetEquations
    sums: tuple[Array, Array]

    @classmethod
    def at(cls, state: State, targets: int) -> _Place:
        """Room for some targets, with the state put in."""
        pose = state.site_from_cam
        sums = np.empty((STATE_COUNT, STATE_COUNT)), np.empty(STATE_COUNT)
        moving = pose.rotation.copy(), pose.position_m.copy(), state.whitened.copy()
        return cls(moving, TargetEquations.room(targets), sums)

    @property
    def arrays(self) -> tuple[object, ...]:
        """As compiled loops take them."""
        return self.state, self.equations.arrays, self.sums


def adjust_pose(
    sighted: SightedTargets,
    prior: CameraPrior,
    start: State,
    options: AdjustmentOptions | None = None,
    free_camera: bool = True,
) -> AdjustedState:
    """Adjust to all of the targets (damped Gauss-Newton), the pose alone when the camera is not free."""
    places = _Place.at(start, len(sighted)), _Place.at(start, len(sighted))
    photo, arrays = (sighted.arrays, prior.arrays), (places[0].arrays, places[1].arrays)
    converged, best, chi2 = descend(photo, arrays, (options or AdjustmentOptions()).limits(free_camera))
    return _adjusted(sighted, places[best], chi2, converged)


def evaluate(sighted: SightedTargets, prior: CameraPrior, state: State) -> AdjustedState:
    """The sum of squares and its normal equations at a state, without moving it."""
    place = _Place.at(state, len(sighted))
    return _adjusted(sighted, place, evaluate_place((sighted.arrays, prior.arrays), place.arrays), converged=False)


def _adjusted(sighted: SightedTargets, place: _Place, chi2: float, converged: bool) -> AdjustedState:
    """What a filled place says."""
    rotation, position_m, whitened = place.state
    information, gradient = place.sums
    return AdjustedState(
        state=State(Pose(rotation, position_m), whitened),
        equations=place.equations,
        information=information,
        gradient=gradient,
        chi2=chi2,
        redundancy=2 * int(np.count_nonzero(sighted.measured)) - POSE_COUNT,
        converged=converged,
    )
