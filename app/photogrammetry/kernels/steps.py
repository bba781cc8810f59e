"""One damped Gauss-Newton step of a photograph's state."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric

Array = npt.NDArray[np.float64]

POSE = 6


@compiled("float64(float64[::1], int64, int64)")
def _norm(values: Array, first: int, last: int) -> float:
    total = 0.0
    for index in range(first, last):
        total += values[index] * values[index]
    return np.sqrt(total)


@compiled("float64(float64[:, :], float64[:], float64, UniTuple(float64, 3), float64[::1])")
def damped_step(
    information: Array, gradient: Array, damping: float, longest: tuple[float, float, float], step: Array
) -> float:
    """The damped step of the first unknowns, written to the front of ``step``; returns the gain that it promises.

    Parameters
    ----------
    information : ndarray of shape (N, N)
    gradient : ndarray of shape (N,)
    damping : float
        Part of the diagonal that is added to it.
    longest : tuple of float
        Longest step of position (m), of rotation (rad), and of the whitened intrinsics; what is longer is cut.
    """
    count = len(gradient)
    normals, moved = np.empty((count, count)), np.empty(count)
    for row in range(count):
        moved[row] = -gradient[row]
        for column in range(count):
            normals[row, column] = information[row, column]
        normals[row, row] *= 1.0 + damping
    solve_symmetric(normals, moved)
    overreach = max(_norm(moved, 0, 3) / longest[0], _norm(moved, 3, POSE) / longest[1])
    cut = max(1.0, overreach, _norm(moved, POSE, count) / longest[2])
    gain = 0.0
    for row in range(count):
        step[row] = moved[row] / cut
    for row in range(count):
        pull = 2.0 * gradient[row]
        for column in range(count):
            pull += information[row, column] * step[column]
        gain -= step[row] * pull
    return gain
