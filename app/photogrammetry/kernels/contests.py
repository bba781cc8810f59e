"""Each target held against the pose that the others give."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric

Array = npt.NDArray[np.float64]


@compiled(
    "void(float64[:, ::1], float64[:, :, :], float64[:, :], UniTuple(float64, 2), "
    "Tuple((float64[:, ::1], float64[::1])))"
)
def leave_each_out(
    information: Array, of_targets: Array, gradients: Array, options: tuple[float, float], found: tuple[Array, Array]
) -> None:
    """The state's step M^-1 g when it gives way to each target, and by how much that target's squares fall, g M^-1 g.

    Parameters
    ----------
    information : ndarray of shape (N, N)
        Of the state.
    of_targets, gradients : ndarray of shape (K, N, N), (K, N)
    options : tuple of float
        The sign with which a target's information joins the state's in M, and the ridge on M's diagonal as a part of
        the state's. With -1 the step is that of leaving the target out.
    found : tuple of ndarray, written
        Steps (K, N) and falls (K,).
    """
    sign, ridge = options
    steps, falls = found
    count = len(information)
    joint = np.empty((count, count))
    for target in range(len(of_targets)):
        step = steps[target]
        for row in range(count):
            step[row] = gradients[target, row]
            for column in range(row + 1):
                joint[row, column] = information[row, column] + sign * of_targets[target, row, column]
            joint[row, row] += ridge * information[row, row]
        solve_symmetric(joint, step)
        falls[target] = 0.0
        for row in range(count):
            falls[target] += gradients[target, row] * step[row]
