"""Columns -> a trajectory: stamps in order, quaternions of unit length, or an error that names the line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.trajectories.reading.table import Table, UnreadableTrajectory
from app.trajectories.reading.time_units import TimeUnit, UnitName, unit_of_stamps
from app.trajectories.trajectory import Array, Trajectory

LENGTH_TOLERANCE = 0.01  # of a quaternion's length: files round to three digits, and anything farther off is a mistake
GREATEST_FLOOR = 1000  # no house has so many
GREATEST_LATENCY_S = 86_400.0  # a day: whatever is farther from its pose's time is of another clock or unit


@dataclass(frozen=True)
class Reading:
    """What a file held.

    Attributes
    ----------
    trajectory : Trajectory
    time_unit : TimeUnit
        In which its stamps counted.
    """

    trajectory: Trajectory
    time_unit: TimeUnit


def times_s_of(table: Table, column: str, own: UnitName, asked: UnitName | None) -> tuple[Array, TimeUnit]:
    """Stamps in seconds, shape (N,), strictly increasing.

    Raises
    ------
    UnreadableTrajectory
        For a stamp that comes twice or goes back, or a change of unit.
    """
    unit = unit_of_stamps(table, column, own, asked)
    times_s = unit.to_seconds(table.column(column))
    late = np.flatnonzero(np.diff(times_s) <= 0)
    if len(late):
        row = int(late[0]) + 1
        what = "comes twice" if times_s[row] == times_s[row - 1] else "is before the one above"
        raise table.refuse(row, column, f"the stamp {what}; sort the poses by time and give each its own")
    return times_s, unit


def unit_quaternions(table: Table, columns: Sequence[str]) -> Array:
    """Quaternions x, y, z, w, shape (N, 4), brought to unit length; ``columns`` name x, y, z, w in this order.

    Raises
    ------
    UnreadableTrajectory
        When a length is not 1 within rounding.
    """
    quaternions = table.block(columns)
    lengths = np.linalg.norm(quaternions, axis=1)
    wrong = np.flatnonzero(np.abs(lengths - 1.0) > LENGTH_TOLERANCE)
    if len(wrong):
        row = int(wrong[0])
        raise table.refuse(row, columns[0], f"the quaternion has the length {lengths[row]:.4g}, and 1 is needed")
    return quaternions / lengths[:, None]


def whole_floors(table: Table, column: str = "floor") -> npt.NDArray[np.int64]:
    """Storeys, shape (N,).

    Raises
    ------
    UnreadableTrajectory
        When one is no whole number.
    """
    floors = table.column(column)
    broken = np.flatnonzero((floors != np.round(floors)) | (np.abs(floors) > GREATEST_FLOOR))
    if len(broken):
        row = int(broken[0])
        raise table.refuse(row, column, f"{floors[row]:g} is no storey; storeys are whole numbers")
    return floors.astype(np.int64)


def check_arrivals(latency_s: Array, refuse: Callable[[int, str], UnreadableTrajectory]) -> None:
    """See that arrivals are near the moments of their poses.

    Parameters
    ----------
    latency_s : ndarray of shape (N,)
    refuse : callable
        Takes a row and what is wrong to the error that points at it.

    Raises
    ------
    UnreadableTrajectory
    """
    wrong = np.flatnonzero(np.abs(latency_s) > GREATEST_LATENCY_S)
    if len(wrong):
        row = int(wrong[0])
        what = f"it is {latency_s[row]:g} s from its pose's time; both count by one clock and in the unit they name"
        raise refuse(row, what)
