"""EuRoC: ``timestamp [ns], p_x, p_y, p_z, q_w, q_x, q_y, q_z`` and, if given, velocities and biases."""

from __future__ import annotations

from app.trajectories.reading.poses import Reading, times_s_of, unit_quaternions
from app.trajectories.reading.table import data_lines, read_table, text_of
from app.trajectories.reading.time_units import UnitName
from app.trajectories.trajectory import Trajectory

POSE = ("timestamp", "p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z")
STATE = (*POSE, "v_x", "v_y", "v_z", "bw_x", "bw_y", "bw_z", "ba_x", "ba_y", "ba_z")


def read_euroc(data: bytes, time_unit: UnitName | None = None) -> Reading:
    """A trajectory in the format of EuRoC's state_groundtruth_estimate0 (Burri et al., IJRR 35(10), 2016).

    Raises
    ------
    UnreadableTrajectory
        Naming line and column.
    """
    lines = data_lines(text_of(data))
    whole = bool(lines) and len(lines[0][1].split(",")) == len(STATE)
    table = read_table(lines, STATE if whole else POSE, ",")
    times_s, unit = times_s_of(table, "timestamp", "ns", time_unit)
    positions_m = table.block(("p_x", "p_y", "p_z"))
    return Reading(Trajectory(times_s, positions_m, unit_quaternions(table, ("q_x", "q_y", "q_z", "q_w"))), unit)
