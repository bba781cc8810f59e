"""A trajectory between its poses: positions on a line or a spline, orientations on the arc between their neighbours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from app.trajectories.trajectory import Array, Trajectory

Course = Literal["linear", "spline"]
Rows = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Between:
    """Where times fall among a trajectory's stamps.

    Attributes
    ----------
    inside : ndarray of bool, shape (K,)
        The time is a stamp, or lies between two that are no more than the largest gap apart.
    before, after : ndarray of int, shape (K,)
        Rows of the two neighbours; the same row twice at a stamp.
    weight : ndarray of shape (K,)
        Of the neighbour after, 0 to 1.
    """

    inside: npt.NDArray[np.bool_]
    before: Rows
    after: Rows
    weight: Array


def find_between(stamps_s: Array, times_s: Array, max_gap_s: float) -> Between:
    """Neighbours of each time among stamps that never decrease.

    Parameters
    ----------
    stamps_s, times_s : ndarray of shape (N,) and (K,)
    max_gap_s : float
        Neighbours farther apart tell nothing of what was between them.
    """
    if len(stamps_s) == 0:
        none = np.zeros(len(times_s), dtype=np.intp)
        return Between(np.zeros(len(times_s), dtype=np.bool_), none, none, np.zeros(len(times_s)))
    last = len(stamps_s) - 1
    after = np.searchsorted(stamps_s, times_s, side="left")
    exact = (after <= last) & (stamps_s[np.minimum(after, last)] == times_s)
    outside = (after > last) | ((after == 0) & ~exact)
    after = np.minimum(after, last)
    before = np.where(exact | outside, after, after - 1)
    width_s = stamps_s[after] - stamps_s[before]
    inside = ~outside & (width_s <= max_gap_s)
    weight = np.divide(times_s - stamps_s[before], width_s, out=np.zeros(len(times_s)), where=width_s > 0)
    return Between(inside, before, after, weight)


def interpolate(trajectory: Trajectory, times_s: Array, max_gap_s: float, course: Course = "linear") -> Trajectory:
    """The trajectory at those of the times that it can tell of.

    Parameters
    ----------
    trajectory : Trajectory
    times_s : ndarray of shape (K,)
        Never decreasing.
    max_gap_s : float
        Largest distance in time of the two poses around.
    course : {"linear", "spline"}
        Straight between two poses, or a cubic through them whose velocities are those of the parabola through each pose
        and its neighbours; the spline does not reach over gaps.

    Returns
    -------
    Trajectory
        At the times for which ``find_between(...).inside``.

    Notes
    -----
    The covariance is the weighted mean of the neighbours'. For errors that the neighbours share (a site's datum) that
    is exact, for independent ones it is an upper bound; how the device moved in between is not in it.
    """
    between = find_between(trajectory.times_s, times_s, max_gap_s)
    kept = np.flatnonzero(between.inside)
    before, after, weight = between.before[kept], between.after[kept], between.weight[kept]
    positions_m = _mean(trajectory.positions_m, before, after, weight)
    if course == "spline":
        positions_m = _on_spline(trajectory, max_gap_s, (before, after, weight))
    assert positions_m is not None
    return Trajectory(
        times_s[kept],
        positions_m,
        _orientations_xyzw(trajectory, before, after, weight),
        _mean(trajectory.covariances, before, after, weight),
        None if trajectory.floors is None else trajectory.floors[np.where(weight > 0.5, after, before)],
    )


def _on_spline(trajectory: Trajectory, max_gap_s: float, place: tuple[Rows, Rows, Array]) -> Array:
    """Cubic Hermite interpolation, shape (K, 3)."""
    before, after, weight = place
    velocities_m_s = _velocities_m_s(trajectory, max_gap_s)
    width_s = (trajectory.times_s[after] - trajectory.times_s[before])[:, None]
    w = weight[:, None]
    start, end = trajectory.positions_m[before], trajectory.positions_m[after]
    rise = (1.0 + 2.0 * w) * (1.0 - w) ** 2 * start + w**2 * (3.0 - 2.0 * w) * end
    bend = w * (1.0 - w) ** 2 * velocities_m_s[before] - w**2 * (1.0 - w) * velocities_m_s[after]
    return rise + width_s * bend


def _velocities_m_s(trajectory: Trajectory, max_gap_s: float) -> Array:
    """Velocity at each pose, shape (N, 3), of the parabola through it and its neighbours that no gap parts from it."""
    step_s = np.diff(trajectory.times_s)
    near = (step_s > 0) & (step_s <= max_gap_s)
    length_s = np.where(near, step_s, 1.0)
    chord_m_s = np.diff(trajectory.positions_m, axis=0) / length_s[:, None]
    # A parabola's slope at the middle pose weighs each chord by the length of the other step; at an end one is left.
    from_left = np.append(0.0, np.where(near, np.append(length_s[1:], 1.0), 0.0))[:, None]
    from_right = np.append(np.where(near, np.append(1.0, length_s[:-1]), 0.0), 0.0)[:, None]
    total = from_left + from_right
    still = np.zeros((1, 3))
    slope_m = from_left * np.concatenate([still, chord_m_s]) + from_right * np.concatenate([chord_m_s, still])
    return slope_m / np.where(total > 0, total, 1.0)


def _orientations_xyzw(trajectory: Trajectory, before: Rows, after: Rows, weight: Array) -> Array | None:
    """Slerp: the rotation from one neighbour to the other, in equal steps about one axis."""
    if trajectory.orientations_xyzw is None:
        return None
    if len(before) == 0:
        return np.zeros((0, 4))
    first, second = (Rotation.from_quat(trajectory.orientations_xyzw[rows]) for rows in (before, after))
    turned = first * Rotation.from_rotvec(weight[:, None] * (first.inv() * second).as_rotvec())
    return turned.as_quat(canonical=True)


def _mean(values: Array | None, before: Rows, after: Rows, weight: Array) -> Array | None:
    if values is None:
        return None
    share = weight.reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - share) * values[before] + share * values[after]
