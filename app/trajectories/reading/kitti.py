"""KITTI: twelve numbers a line, the upper rows of site_from_cam; the stamps stand in a file of their own."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from app.trajectories.reading.poses import Reading, times_s_of
from app.trajectories.reading.table import Table, UnreadableTrajectory, data_lines, read_table, text_of
from app.trajectories.reading.time_units import UnitName
from app.trajectories.trajectory import Array, Trajectory

COLUMNS = tuple(f"{'r' if column < 3 else 't'}{row}{column}" for row in range(3) for column in range(4))
ORTHOGONALITY = 0.01  # of a rotation matrix: files round to a few digits


def read_kitti(poses: bytes, times: bytes, time_unit: UnitName | None = None) -> Reading:
    """A trajectory in the format of the KITTI odometry benchmark (Geiger et al., CVPR 2012).

    Parameters
    ----------
    poses : bytes
        Lines of 12 numbers, row-major.
    times : bytes
        A stamp a line, as many.

    Raises
    ------
    UnreadableTrajectory
        Naming line and column.
    """
    table = read_table(data_lines(text_of(poses)), COLUMNS)
    stamps = read_table(data_lines(text_of(times)), ("timestamp",))
    if len(stamps.lines) != len(table.lines):
        raise UnreadableTrajectory(
            f"{len(table.lines)} poses and {len(stamps.lines)} stamps; KITTI takes one line of times.txt for each pose"
        )
    times_s, unit = times_s_of(stamps, "timestamp", "s", time_unit)
    matrices = table.values.reshape(-1, 3, 4)
    orientations_xyzw = Rotation.from_matrix(_rotations(table, matrices[:, :, :3])).as_quat(canonical=True)
    return Reading(Trajectory(times_s, matrices[:, :, 3].copy(), orientations_xyzw), unit)


def _rotations(table: Table, matrices: Array) -> Array:
    """The rotations nearest to what was written, shape (N, 3, 3)."""
    product = matrices @ matrices.transpose(0, 2, 1)
    off = np.abs(product - np.eye(3)).max(axis=(1, 2))
    wrong = np.flatnonzero((off > ORTHOGONALITY) | (np.linalg.det(matrices) < 0))
    if len(wrong):
        raise table.refuse(int(wrong[0]), COLUMNS[0], "the 3 x 3 part is no rotation; write site_from_cam row by row")
    u, _, vt = np.linalg.svd(matrices)
    return u @ vt
