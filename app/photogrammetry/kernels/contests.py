"""Each target held against the pose that the others give."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric

Array = npt.NDArray[np.float64]


@compiled("void(float64[:, ::1], float64[:, :, :], float64[:, :], UniTuple(float64, 2), float64[::1])")
def correct_squares(
    information: Array, of_targets: Array, gradients: Array, options: tuple[float, float], corrections: Array
) -> None:
    """By how much each target's squares fall when the state gives way to it, shape (K,), written: g M^-1 g.

    Parameters
    ----------
    information : ndarray of shape (N, N)
        Of the state.
    of_targets, gradients : ndarray of shape (K, N, N), (K, N)
    options : tuple of float
        The sign with which a target's information joins the state's in M, and the ridge on M's diagonal as a part of
        the state's.
    """
    sign, ridge = options
    count = len(information)
    joint, moved = np.empty((count, count)), np.empty(count)
    for target in range(len(of_targets)):
        for row in range(count):
            moved[row] = gradients[target, row]
            for column in range(row + 1):
                joint[row, column] = information[row, column] + sign * of_targets[target, row, column]
            joint[row, row] += ridge * information[row, row]
        solve_symmetric(joint, moved)
        corrections[target] = 0.0
        for row in range(count):
            corrections[target] += gradients[target, row] * moved[row]
