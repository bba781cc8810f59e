"""Which points of a plate are in sight beside what covers its sides."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.sides import HALF_PLATE_U, SIDES

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@compiled("UniTuple(float64, 2)(int64, float64, float64)")
def to_side(side: int, x_u: float, y_u: float) -> tuple[float, float]:
    """How far a plate point lies across, and inwards from, the top, right, bottom or left side."""
    if side == 0:
        return x_u, y_u + HALF_PLATE_U
    if side == 1:
        return y_u, HALF_PLATE_U - x_u
    if side == 2:
        return -x_u, HALF_PLATE_U - y_u
    return -y_u, x_u + HALF_PLATE_U


@compiled("float64(float64, float64[::1], float64[::1])")
def _depth_at(across_u: float, lines_u: Array, depths_u: Array) -> float:
    """Between two lines the depth goes straight from one's to the other's; beyond the last it stays."""
    if across_u <= lines_u[0]:
        return depths_u[0]
    for line in range(1, len(lines_u)):
        if across_u < lines_u[line]:
            share = (across_u - lines_u[line - 1]) / (lines_u[line] - lines_u[line - 1])
            return depths_u[line - 1] + share * (depths_u[line] - depths_u[line - 1])
    return depths_u[-1]


@compiled("void(float64[:, :, ::1], float64[::1], float64[:, ::1], boolean[:, ::1])")
def mark_seen(depths_u: Array, lines_u: Array, points_u: Array, seen: Mask) -> None:
    """Whether each of S plate points is in sight on each of P plates.

    Parameters
    ----------
    depths_u : ndarray of shape (P, 4, 5)
        How far each side is covered on each line; 0 where it is not.
    lines_u : ndarray of shape (5,)
        Where the lines are, across, ascending.
    points_u : ndarray of shape (S, 2)
    seen : ndarray of shape (P, S), written
    """
    seen[:] = True
    for plate in range(len(depths_u)):
        for side in range(SIDES):
            if depths_u[plate, side].max() > 0.0:
                for point in range(len(points_u)):
                    across_u, inwards_u = to_side(side, points_u[point, 0], points_u[point, 1])
                    if not inwards_u > _depth_at(across_u, lines_u, depths_u[plate, side]):
                        seen[plate, point] = False
