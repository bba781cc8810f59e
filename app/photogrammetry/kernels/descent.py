"""Damped Gauss-Newton over the pose and the camera of one photograph, from start to optimum in one call."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.rotation import turn_rotation
from app.photogrammetry.kernels.layout import INTRINSICS, OWN
from app.photogrammetry.kernels.products import linearise_targets
from app.photogrammetry.kernels.steps import damped_step

Array = npt.NDArray[np.float64]

STATE = OWN + INTRINSICS  # the pose's six, then the whitened intrinsics
PIXELS = 4  # of the intrinsics, fx, fy, cx and cy are in px
LEAST_SHRINKING, STEEPNESS = 1.0 / 3.0, 3  # Nielsen, Damping Parameter in Marquardt's Method, 1999, equation 2.9
LEAST_FOCAL_SHARE = 0.1  # of the prior's: a walk of many sigmas of a camera that is hardly known goes no further
FORGOTTEN = 0.1  # damping under this part of the first is none

STATES = "Tuple((float64[:, ::1], float64[::1], float64[::1]))"
PRIOR = "Tuple((float64[::1], float64[:, ::1]))"
PHOTO = (
    "Tuple((Tuple((float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], "
    f"float64[:, :, ::1], boolean[:, ::1], float64[:, :, ::1], float64[:, ::1])), {PRIOR}))"
)
EQUATIONS = "Tuple((float64[:, :, ::1], float64[:, :, ::1], boolean[::1]))"
SUMS = "Tuple((float64[:, ::1], float64[::1]))"
PLACE = f"Tuple(({STATES}, {EQUATIONS}, {SUMS}))"


@compiled("float64(float64[:, :, ::1], float64[::1], Tuple((float64[:, ::1], float64[::1])))")
def sum_equations(reduced: Array, whitened: Array, sums: tuple[Array, Array]) -> float:
    """Information (15, 15) and gradient (15,), written, of all targets and the camera's prior; the sum of squares."""
    information, gradient = sums
    information[:], gradient[:], chi2 = 0.0, 0.0, 0.0
    for target in range(len(reduced)):
        for row in range(STATE):
            for column in range(STATE):
                information[row, column] += reduced[target, row, column]
            gradient[row] += reduced[target, row, STATE]
        chi2 += reduced[target, STATE, STATE]
    for intrinsic in range(INTRINSICS):
        information[OWN + intrinsic, OWN + intrinsic] += 1.0
        gradient[OWN + intrinsic] += whitened[intrinsic]
        chi2 += whitened[intrinsic] ** 2
    return chi2


@compiled(f"float64({PHOTO}, {PLACE})")
def evaluate_place(photo: tuple[Any, ...], place: tuple[Any, ...]) -> float:
    """Equations and their sums at a state, written; the sum of squares.

    Parameters
    ----------
    photo : tuple
        The fields of ``SightedTargets`` from ``rotations`` on; mean intrinsics (9,) and the root of their covariance
        (9, 9).
    place : tuple
        The state: rotation (3, 3), position (3,), whitened intrinsics (9,). Written: what ``linearise_targets`` and
        ``sum_equations`` write.
    """
    sighted, prior = photo
    state, equations, sums = place
    mean, root = prior
    intrinsics = mean.copy()
    for row in range(INTRINSICS):
        for column in range(INTRINSICS):
            intrinsics[row] += root[row, column] * state[2][column]
    for axis in range(2):
        intrinsics[axis] = max(intrinsics[axis], LEAST_FOCAL_SHARE * mean[axis])
    linearise_targets((state[0], state[1], intrinsics, root), sighted, equations)
    return sum_equations(equations[1], state[2], sums)


@compiled(f"void({STATES}, float64[::1], {STATES})")
def move_state(state: tuple[Array, Array, Array], step: Array, moved: tuple[Array, Array, Array]) -> None:
    """A state after a step of shape (15,), written."""
    turn_rotation(state[0], step[3:OWN], moved[0])
    for axis in range(3):
        moved[1][axis] = state[1][axis] + step[axis]
    for intrinsic in range(INTRINSICS):
        moved[2][intrinsic] = state[2][intrinsic] + step[OWN + intrinsic]


@compiled(f"float64({PLACE}, float64[::1], float64)")
def _advance_place(place: tuple[Any, ...], step: Array, chi2: float) -> float:
    """A place after a step of shape (15,), along which its equations are linear; the sum of squares there."""
    state, (_, reduced, _), (information, gradient) = place
    move_state(state, step, state)
    for target in range(len(reduced)):
        products = reduced[target]
        for row in range(STATE):
            moved = 0.0
            for column in range(STATE):
                moved += products[row, column] * step[column]
            products[STATE, STATE] += step[row] * (2.0 * products[STATE, row] + moved)
            products[STATE, row] += moved
            products[row, STATE] = products[STATE, row]
        products[STATE, STATE] = max(products[STATE, STATE], 0.0)
    for row in range(STATE):
        moved = 0.0
        for column in range(STATE):
            moved += information[row, column] * step[column]
        chi2 += step[row] * (2.0 * gradient[row] + moved)
        gradient[row] += moved
    return max(chi2, 0.0)


@compiled(f"float64(float64[::1], float64, {PRIOR})")
def _length(step: Array, nearest_m: float, prior: tuple[Array, Array]) -> float:
    """The greatest of a step's rotation (rad), shift (nearest distances) and camera (units of the image plane)."""
    mean, root = prior
    shift, turn, longest = 0.0, 0.0, 0.0
    for axis in range(3):
        shift += step[axis] ** 2
        turn += step[3 + axis] ** 2
    for row in range(INTRINSICS):
        change = 0.0
        for column in range(INTRINSICS):
            change += root[row, column] * step[OWN + column]
        longest = max(longest, abs(change) / (mean[0] if row < PIXELS else 1.0))
    return max(np.sqrt(shift) / nearest_m, np.sqrt(turn), longest)


@compiled("UniTuple(float64, 2)(float64[:, ::1], float64[::1])")
def _nearest_and_middle(centres_m: Array, position_m: Array) -> tuple[float, float]:
    """Least and (upper) median distance to the targets' centres."""
    distances_m = np.empty(len(centres_m))
    for target in range(len(centres_m)):
        square = 0.0
        for axis in range(3):
            square += (centres_m[target, axis] - position_m[axis]) ** 2
        distances_m[target] = np.sqrt(square)
    distances_m.sort()
    return distances_m[0], distances_m[len(distances_m) // 2]


@compiled("UniTuple(float64, 2)(UniTuple(float64, 2), float64, float64)")
def _next_damping(damping: tuple[float, float], gain_ratio: float, first: float) -> tuple[float, float]:
    """Damping and the factor of its next growth after a step that gained this much of what it promised."""
    value, growth = damping
    if gain_ratio <= 0.0:
        return max(first, value * growth), growth * 2.0
    value *= max(LEAST_SHRINKING, 1.0 - (2.0 * gain_ratio - 1.0) ** STEEPNESS)
    return (value if value > FORGOTTEN * first else 0.0), 2.0


@compiled(f"float64({PHOTO}, {PLACE}, float64[::1])")
def _return_to_floor(photo: tuple[Any, ...], place: tuple[Any, ...], longest: Array) -> float:
    """Step the pose alone: distance and focal length trade along a curved valley, and this leads back to its floor."""
    state, _, sums = place
    step = np.zeros(STATE)
    damped_step(sums[0][:OWN, :OWN], sums[1][:OWN], 0.0, (longest[0], longest[1], longest[2]), step)
    move_state(state, step, state)
    return evaluate_place(photo, place)


@compiled(
    f"Tuple((boolean, int64, float64))({PHOTO}, UniTuple({PLACE}, 2), "
    "Tuple((int64, boolean, float64, float64, float64, float64, float64, float64)))"
)
def descend(
    photo: tuple[Any, ...], places: tuple[tuple[Any, ...], ...], limits: tuple[Any, ...]
) -> tuple[bool, int, float]:
    """Adjust to all targets; whether it converged, in which of the two places the best stands, its squares.

    The last step, which is short, is taken along equations that stay as they are.

    Parameters
    ----------
    photo : tuple
    places : pair of tuple
        As ``evaluate_place`` takes them. The first state is the start; best and trial take turns.
    limits : tuple
        Most steps, whether the camera is free, then the limits of ``AdjustmentOptions`` in their order.
    """
    max_steps, free_camera, converged_sigmas, linear_step, near_step, max_camera, max_shift, first_damping = limits
    sighted, prior = photo
    damping, unknowns, best, longest = (0.0, 2.0), OWN, 0, np.array([0.0, max_shift, max_camera])
    chi2, step = evaluate_place(photo, places[0]), np.zeros(STATE)
    for _ in range(max_steps):
        state, _, (information, gradient) = places[best]
        nearest_m, middle_m = _nearest_and_middle(sighted[1], state[1])
        longest[0] = max_shift * middle_m
        cuts = (longest[0], longest[1], longest[2])
        step[:] = 0.0
        gain = damped_step(information[:unknowns, :unknowns], gradient[:unknowns], 0.0, cuts, step)
        length = _length(step, nearest_m, prior)
        if free_camera and unknowns == OWN and (gain < 1.0 or length < near_step):
            unknowns = STATE
            gain = damped_step(information, gradient, 0.0, cuts, step)
            length = _length(step, nearest_m, prior)
        if (gain < converged_sigmas**2 or length < linear_step) and (unknowns == STATE or not free_camera):
            return True, best, _advance_place(places[best], step, chi2)
        if damping[0] > 0.0:
            gain = damped_step(information[:unknowns, :unknowns], gradient[:unknowns], damping[0], cuts, step)
        trial = places[1 - best]
        move_state(state, step, trial[0])
        trial_chi2 = evaluate_place(photo, trial)
        if trial_chi2 > chi2 and unknowns == STATE:
            trial_chi2 = _return_to_floor(photo, trial, longest)
        # At the optimum rounding, and covariances that depend on the state a little, may cost what a step promises.
        gained = chi2 - trial_chi2 + converged_sigmas**2
        damping = _next_damping(damping, gained / gain, first_damping)
        if gained > 0.0:
            best, chi2 = 1 - best, trial_chi2
    return False, best, chi2
