"""Forwards through the poses with a Kalman filter, back with a Rauch-Tung-Striebel smoother."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from app.errors import InvalidInput
from app.geometry.rotation import log_rotation
from app.trajectories.interpolation import find_between
from app.trajectories.smoothing.motion import POSE, STATE, MotionOptions, State, predict
from app.trajectories.trajectory import Array, Trajectory


@dataclass(frozen=True)
class SmootherOptions:
    """How far the poses carry.

    Attributes
    ----------
    motion : MotionOptions
    max_gap_s : float
        Between poses farther apart nothing is told: whoever was not seen for three seconds may have turned round.
    """

    motion: MotionOptions = field(default_factory=MotionOptions)
    max_gap_s: float = 3.0


@dataclass(frozen=True)
class _Moment:
    """One step of the forward run."""

    predicted: State
    transition: Array
    filtered: State


def smooth_at(trajectory: Trajectory, times_s: Array, options: SmootherOptions | None = None) -> Trajectory:
    """The trajectory at times at or between its poses, with covariances.

    Parameters
    ----------
    trajectory : Trajectory
        With orientations and covariances; stamps strictly increasing.
    times_s : ndarray of shape (K,)
        Strictly increasing.
    options : SmootherOptions, optional

    Returns
    -------
    Trajectory
        At those of the times that lie at a pose, or between two that are no farther apart than the largest gap.

    Raises
    ------
    InvalidInput
        Without orientations or covariances, or with times that do not increase.

    Notes
    -----
    Särkkä, Bayesian Filtering and Smoothing, 2013, sections 5.2 and 9.1, with errors of rotation from the left. The
    poses count as independent. What they share (a site's datum) is far below what a walker does between two looks, so
    that it is neither averaged away nor counted twice to any degree that shows.
    """
    options = options or SmootherOptions()
    _check(trajectory, times_s)
    asked_s = times_s[find_between(trajectory.times_s, times_s, options.max_gap_s).inside]
    breaks = np.flatnonzero(np.diff(trajectory.times_s) > options.max_gap_s) + 1
    parts = [
        _smooth_part(trajectory.take(rows), asked_s, options.motion)
        for rows in np.split(np.arange(len(trajectory)), breaks)
        if len(rows)
    ]
    return _trajectory(asked_s, [state for part in parts for state in part])


def _check(trajectory: Trajectory, times_s: Array) -> None:
    if trajectory.orientations_xyzw is None or trajectory.covariances is None:
        raise InvalidInput(
            "smoothing takes poses with orientations and covariances; take a trajectory that was located"
        )
    for name, stamps_s in (("the trajectory's stamps", trajectory.times_s), ("the times asked for", times_s)):
        if (np.diff(stamps_s) <= 0).any():
            raise InvalidInput(f"{name} must increase from one to the next; leave out those that come twice")


def _smooth_part(part: Trajectory, asked_s: Array, options: MotionOptions) -> list[State]:
    """States at the times within a stretch without gaps."""
    wanted_s = asked_s[(asked_s >= part.times_s[0]) & (asked_s <= part.times_s[-1])]
    if len(wanted_s) == 0:
        return []
    moments_s = np.union1d(part.times_s, wanted_s)
    smoothed = _backwards(_forwards(part, moments_s, options))
    return [smoothed[row] for row in np.searchsorted(moments_s, wanted_s)]


def _forwards(part: Trajectory, moments_s: Array, options: MotionOptions) -> list[_Moment]:
    rotations, covariances = part.rotations, part.covariances
    assert rotations is not None and covariances is not None
    state = _first_state(part.positions_m[0], rotations[0], (covariances[0], options))
    moments = [_Moment(state, np.eye(STATE), state)]
    row = 1
    for before_s, now_s in pairwise(moments_s):
        predicted, transition = predict(state, float(now_s - before_s), options)
        state = predicted
        if row < len(part) and part.times_s[row] == now_s:
            state = _corrected(predicted, part.positions_m[row], rotations[row], covariances[row])
            row += 1
        moments.append(_Moment(predicted, transition, state))
    return moments


def _first_state(position_m: Array, rotation: Array, known: tuple[Array, MotionOptions]) -> State:
    """The first pose as it was measured, and velocities of which nothing is known but what walkers do."""
    pose_covariance, options = known
    covariance = np.zeros((STATE, STATE))
    covariance[:POSE, :POSE] = pose_covariance
    covariance[POSE:, POSE:] = np.diag(options.first_variances)
    return State(position_m, rotation, np.zeros(3), np.zeros(3), covariance)


def _corrected(predicted: State, position_m: Array, rotation: Array, covariance: Array) -> State:
    """The state after a pose was measured (Kalman's update in Joseph's form, which stays symmetric)."""
    innovation = np.concatenate([position_m - predicted.position_m, log_rotation(rotation @ predicted.rotation.T)])
    prior = predicted.covariance
    gain = np.linalg.solve(prior[:POSE, :POSE] + covariance, prior[:POSE]).T
    left = np.eye(STATE)
    left[:, :POSE] -= gain
    return predicted.plus(gain @ innovation, left @ prior @ left.T + gain @ covariance @ gain.T)


def _backwards(moments: list[_Moment]) -> list[State]:
    smoothed = [moments[-1].filtered]
    for moment, later in zip(moments[-2::-1], moments[:0:-1], strict=True):
        ahead = smoothed[-1]
        gain = np.linalg.solve(later.predicted.covariance, later.transition @ moment.filtered.covariance).T
        change = gain @ ahead.minus(later.predicted)
        covariance = moment.filtered.covariance + gain @ (ahead.covariance - later.predicted.covariance) @ gain.T
        smoothed.append(moment.filtered.plus(change, (covariance + covariance.T) / 2.0))
    return smoothed[::-1]


def _trajectory(times_s: Array, states: list[State]) -> Trajectory:
    if not states:
        return Trajectory(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 4)), np.zeros((0, POSE, POSE)))
    rotations = np.array([state.rotation for state in states])
    return Trajectory(
        times_s,
        np.array([state.position_m for state in states]),
        Rotation.from_matrix(rotations).as_quat(canonical=True),
        np.array([state.covariance[:POSE, :POSE] for state in states]),
    )
