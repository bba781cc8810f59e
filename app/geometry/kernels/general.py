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
        best = pivot + int(np.argmax(np.abs(matrix[pivot:, pivot])))
        _swap_rows(matrix, pivot, best)
        _swap_rows(right, pivot, best)
        for row in range(pivot + 1, count):
            factor = matrix[row, pivot] / matrix[pivot, pivot]
            for column in range(pivot, count):
                matrix[row, column] -= factor * matrix[pivot, column]
            for column in range(width):
                right[row, column] -= factor * right[pivot, column]
    for row in range(count - 1, -1, -1):
        for column in range(width):
            value = right[row, column]
            for inner in range(row + 1, count):
                value -= matrix[row, inner] * right[inner, column]
            right[row, column] = value / matrix[row, row]
