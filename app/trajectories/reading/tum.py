"""TUM: ``time x y z qx qy qz qw`` a line."""

from __future__ import annotations

from app.trajectories.reading.poses import Reading, times_s_of, unit_quaternions
from app.trajectories.reading.table import data_lines, read_table, text_of
from app.trajectories.reading.time_units import UnitName
from app.trajectories.trajectory import Trajectory

COLUMNS = ("timestamp", "x", "y", "z", "qx", "qy", "qz", "qw")


def read_tum(data: bytes, time_unit: UnitName | None = None) -> Reading:
    """A trajectory in the format of the TUM RGB-D benchmark (Sturm et al., IROS 2012).

    Raises
    ------
    UnreadableTrajectory
        Naming line and column.
    """
    table = read_table(data_lines(text_of(data)), COLUMNS)
    times_s, unit = times_s_of(table, "timestamp", "s", time_unit)
    positions_m = table.block(("x", "y", "z"))
    return Reading(Trajectory(times_s, positions_m, unit_quaternions(table, ("qx", "qy", "qz", "qw"))), unit)
