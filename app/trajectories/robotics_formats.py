"""Trajectories as the benchmarks of robotics have them: TUM, KITTI, EuRoC; part by part as ``formats``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from app.errors import InvalidInput
from app.trajectories.trajectory import Array, Trajectory

TUM_LINE = "%.6f %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n"
KITTI_LINE = " ".join(["%.9f %.9f %.9f %.6f"] * 3) + "\n"
STAMP_LINE = "%.6f\n"
EUROC_HEADING = (
    "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
)
EUROC_LINE = "%d,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f\n"
MICROSECONDS, NANOSECONDS_EACH = 1e6, 1000


def tum_text(parts: Iterable[Trajectory]) -> Iterator[str]:
    """Lines ``time x y z qx qy qz qw``: seconds, metres, site_from_cam.

    Notes
    -----
    The format of the TUM RGB-D benchmark (Sturm et al., IROS 2012), which the evaluation tools of robotics read.
    """
    for part in parts:
        rows = np.column_stack([part.times_s, part.positions_m, orientations_of(part)]).tolist()
        yield "".join(TUM_LINE % tuple(row) for row in rows)


def kitti_text(parts: Iterable[Trajectory]) -> Iterator[str]:
    """Lines of twelve numbers, the upper rows of site_from_cam; without stamps, which ``kitti_times_text`` writes.

    Notes
    -----
    The format of the KITTI odometry benchmark (Geiger et al., CVPR 2012).
    """
    for part in parts:
        orientations_of(part)
        rotations = part.rotations
        assert rotations is not None
        rows = np.concatenate([rotations, part.positions_m[:, :, None]], axis=2).reshape(len(part), -1).tolist()
        yield "".join(KITTI_LINE % tuple(row) for row in rows)


def kitti_times_text(parts: Iterable[Trajectory]) -> Iterator[str]:
    """KITTI's times.txt: a stamp in seconds a line."""
    for part in parts:
        yield "".join(STAMP_LINE % stamp_s for stamp_s in part.times_s.tolist())


def euroc_text(parts: Iterable[Trajectory]) -> Iterator[str]:
    """Lines ``timestamp,x,y,z,qw,qx,qy,qz`` under a heading; stamps in whole nanoseconds, to the microsecond.

    Notes
    -----
    The pose columns of EuRoC's state_groundtruth_estimate0 (Burri et al., IJRR 35(10), 2016).
    """
    yield EUROC_HEADING
    for part in parts:
        stamps_ns = np.round(part.times_s * MICROSECONDS).astype(np.int64) * NANOSECONDS_EACH
        rows = np.column_stack([part.positions_m, orientations_of(part)[:, [3, 0, 1, 2]]]).tolist()
        yield "".join(EUROC_LINE % (stamp_ns, *row) for stamp_ns, row in zip(stamps_ns.tolist(), rows, strict=True))


def orientations_of(part: Trajectory) -> Array:
    """The orientations that a format needs.

    Raises
    ------
    InvalidInput
        When there are none.
    """
    if part.orientations_xyzw is None:
        raise InvalidInput("the trajectory has positions only, and this format needs orientations; ask for csv")
    return part.orientations_xyzw
