"""IPIN and EvAAL: the true positions in a log file's POSI lines, and the position log that a competitor hands in."""

from __future__ import annotations

import numpy as np

from app.trajectories.reading.poses import Reading, times_s_of, whole_floors
from app.trajectories.reading.table import Table, UnreadableTrajectory, data_lines, read_table, text_of
from app.trajectories.reading.time_units import UnitName
from app.trajectories.trajectory import Trajectory

POSI = "POSI;"
POSI_COLUMNS = ("kind", "timestamp", "counter", "latitude", "longitude", "floor", "building")
LOG_COLUMNS = ("timestamp", "x_m", "y_m", "floor")
SEPARATORS = (",", ";", None)


def read_position_log(data: bytes, time_unit: UnitName | None = None) -> Reading:
    """A position log: ``timestamp, x, y, floor`` a line, in metres of the site; between commas, semicolons or blanks.

    Raises
    ------
    UnreadableTrajectory
        Naming line and column.
    """
    lines = data_lines(text_of(data))
    separator = next((mark for mark in SEPARATORS if mark is None or (lines and mark in lines[0][1])), None)
    table = read_table(lines, LOG_COLUMNS, separator)
    times_s, unit = times_s_of(table, "timestamp", "s", time_unit)
    plan_m = table.block(("x_m", "y_m"))
    positions_m = np.column_stack([plan_m, np.zeros(len(plan_m))])
    return Reading(Trajectory(times_s, positions_m, floors=whole_floors(table)), unit)


def posi_table(data: bytes) -> Table:
    """The POSI lines of an IPIN log file: ``POSI;timestamp;counter;latitude;longitude;floor;building``.

    Raises
    ------
    UnreadableTrajectory
        When there is none, or one is malformed.
    """
    lines = [
        (number, line.strip().rstrip(";")[len(POSI) :])
        for number, line in enumerate(text_of(data).splitlines(), start=1)
        if line.startswith(POSI)
    ]
    if not lines:
        raise UnreadableTrajectory("the log holds no POSI line, so no true position; send a log with ground truth")
    return read_table(lines, POSI_COLUMNS[1:], ";")
