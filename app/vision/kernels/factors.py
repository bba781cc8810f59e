"""Symmetric equations of some fifty unknowns, by Cholesky's factor and its inverse, row by row.

Unknowns that have nothing in common leave zeros; before a row's first entry the factor has none either.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@compiled("void(float64[:, ::1], int64[::1])")
def factorise(normals: Array, begins: Indices) -> None:
    """The lower triangle of a positive definite matrix becomes that of its factor L, with L L^T the matrix.

    Parameters
    ----------
    normals : ndarray of shape (N, N)
    begins : ndarray of shape (N,), written
        Where each row's entries begin.
    """
    for row in range(len(normals)):
        line, begin = normals[row], 0
        while begin < row and line[begin] == 0.0:
            begin += 1
        begins[row] = begin
        for column in range(begin, row):
            other, value = normals[column], line[column]
            for inner in range(max(begin, begins[column]), column):
                value -= line[inner] * other[inner]
            line[column] = value / other[column]
        value = line[row]
        for inner in range(begin, row):
            value -= line[inner] * line[inner]
        line[row] = np.sqrt(value)


@compiled("void(float64[:, ::1], int64[::1], float64[:, ::1])")
def invert_lower(factor: Array, begins: Indices, inverse: Array) -> None:
    """The inverse, written, of a lower triangle whose rows begin where ``begins`` says; zeros above it."""
    inverse[:] = 0.0
    for row in range(len(factor)):
        line, share = inverse[row], 1.0 / factor[row, row]
        for other in range(begins[row], row):
            above, by = inverse[other], factor[row, other] * share
            for column in range(other + 1):
                line[column] -= by * above[column]
        line[row] = share


@compiled("void(float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def solve_by_inverse(inverse: Array, right: Array, solved: Array) -> None:
    """Solutions, written, of (L L^T) x = b for several b, one per row, with the inverse of L."""
    solved[:] = 0.0
    for case in range(len(right)):
        for row in range(len(inverse)):
            line, value = inverse[row], 0.0
            for column in range(row + 1):
                value += line[column] * right[case, column]
            for column in range(row + 1):
                solved[case, column] += line[column] * value
