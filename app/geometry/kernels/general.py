"""Small linear equations, solved in place."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]


@compiled("void(float64[:, ::1], int64, int64)")
def _swap_rows(matrix: Array, first: int, second: int) -> None:
    for column in range(matrix.shape[1]):
        matrix[first, column], matrix[second, column] = matrix[second, column], matrix[first, column]


@compiled("void(float64[:, ::1], float64[:, ::1])")
def solve_general(matrix: Array, right: Array) -> None:
    """Solve ``matrix @ x = right`` by elimination with row pivots; both are overwritten, ``right`` by the solution.

    Parameters
    ----------
    matrix : ndarray of shape (N, N)
    right : ndarray of shape (N, M)
    """
    count, width = right.shape
    for pivot in range(count):
        best = pivot
        for row in range(pivot + 1, count):
            best = row if abs(matrix[row, pivot]) > abs(matrix[best, pivot]) else best
        _swap_rows(matrix, pivot, best)
        _swap_rows(right, pivot, best)
        scale = 1.0 / matrix[pivot, pivot]
        for row in range(pivot + 1, count):
            factor = scale * matrix[row, pivot]
            for column in range(pivot, count):
                matrix[row, column] -= factor * matrix[pivot, column]
            for column in range(width):
                right[row, column] -= factor * right[pivot, column]
    for row in range(count - 1, -1, -1):
        for inner in range(row + 1, count):
            for column in range(width):
                right[row, column] -= matrix[row, inner] * right[inner, column]
        scale = 1.0 / matrix[row, row]
        for column in range(width):
            right[row, column] *= scale
