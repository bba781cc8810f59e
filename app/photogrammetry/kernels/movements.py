"""One step of each target to where its dots fit best, seen from a pose that stays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric
from app.photogrammetry.kernels.layout import OWN

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

TINY = float(np.finfo(np.float64).tiny)


@compiled("boolean(float64[:, ::1], float64)")
def _exceeds(matrix: Array, least: float) -> bool:
    """Whether all eigenvalues of a symmetric matrix exceed a number: then, and only then, all pivots less it do."""
    left = matrix.copy()
    for pivot in range(OWN):
        left[pivot, pivot] -= least
    for pivot in range(OWN):
        if not left[pivot, pivot] > 0.0:
            return False
        for row in range(pivot + 1, OWN):
            factor = left[row, pivot] / left[pivot, pivot]
            for column in range(pivot + 1, row + 1):
                left[row, column] -= factor * left[column, pivot]
    return True


@compiled("void(float64[:, :, ::1], float64, boolean[::1], float64[:, ::1])")
def step_movements(gram: Array, least_condition: float, determined: Mask, steps: Array) -> None:
    """Steps of translation (m) and small rotation (rad), (K, 6), written, and whether the dots determine them, (K,).

    Parameters
    ----------
    gram : ndarray of shape (K, 16, 16)
        Products of the whitened columns: the movement's six come first, the residual last.
    least_condition : float
        What all eigenvalues of a normal matrix must exceed, its diagonal scaled to 1.
    """
    scale, normals = np.empty(OWN), np.empty((OWN, OWN))
    for target in range(len(gram)):
        products, step = gram[target], steps[target]
        for row in range(OWN):
            scale[row] = np.sqrt(max(products[row, row], TINY))
            step[row] = -products[row, -1] / scale[row]
            for column in range(row + 1):
                normals[row, column] = products[row, column] / (scale[row] * scale[column])
        determined[target] = _exceeds(normals, least_condition)
        solve_symmetric(normals, step)
        for row in range(OWN):
            step[row] /= scale[row]
