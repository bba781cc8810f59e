"""Each target held against the pose that the others give."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric

Array = npt.NDArray[np.float64]


@compiled(
    "void(float64[:, ::1], Tuple((float64[:, :, ::1], boolean[::1], float64[::1])), UniTuple(float64, 2), float64[::1])"
)
def contest_targets(information: Array, targets: tuple[Any, ...], options: tuple[float, float], chi2: Array) -> None:
    """Chi-square of each target's rigid movement against a state, shape (K,), written; infinite if seen from behind.

    With residuals r of covariance S, design A and a state of covariance P, the target against the state is
    r^T (S + A P A^T)^-1 r = chi2 - g^T (P^-1 + A^T S^-1 A)^-1 g with g = A^T S^-1 r, by Woodbury's identity. Taking the
    target out of a state that it took part in turns the sign of its information and of the correction.

    Parameters
    ----------
    information : ndarray of shape (N, N)
        Of the state.
    targets : tuple of ndarray
        Products (K, N + 1, N + 1) of pose, camera and residual; which targets are seen from the front (K,); the part of
        their squares that no movement explains (K,).
    options : tuple of float
        The sign with which a target's information joins the state's, and the ridge on the sum's diagonal as a part of
        the state's.
    """
    reduced, seen_from_front, shape_chi2 = targets
    sign, ridge = options
    count = len(information)
    joint, moved = np.empty((count, count)), np.empty(count)
    for target in range(len(reduced)):
        products = reduced[target]
        for row in range(count):
            moved[row] = products[count, row]
            for column in range(row + 1):
                joint[row, column] = information[row, column] + sign * products[row, column]
            joint[row, row] += ridge * information[row, row]
        solve_symmetric(joint, moved)
        left = products[count, count] - shape_chi2[target]
        for row in range(count):
            left -= sign * products[count, row] * moved[row]
        chi2[target] = max(left, 0.0) if seen_from_front[target] else np.inf
