"""Small symmetric equations, solved in place."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]


@compiled("void(float64[:, ::1], float64[::1])")
def solve_symmetric(normals: Array, right: Array) -> None:
    """Solve symmetric positive definite equations by L D L^T; both are overwritten, ``right`` by the solution.

    Parameters
    ----------
    normals : ndarray of shape (N, N)
        Its lower triangle is read.
    right : ndarray of shape (N,)
    """
    count = len(right)
    for column in range(count):
        for row in range(column, count):
            value = normals[row, column]
            for inner in range(column):
                value -= normals[row, inner] * normals[column, inner] * normals[inner, inner]
            normals[row, column] = value if row == column else value / normals[column, column]
    for row in range(count):
        for inner in range(row):
            right[row] -= normals[row, inner] * right[inner]
    for row in range(count - 1, -1, -1):
        right[row] /= normals[row, row]
        for inner in range(row + 1, count):
            right[row] -= normals[inner, row] * right[inner]
