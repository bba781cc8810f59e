"""Covariances that a file tells: such errors must be possible."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from app.trajectories.reading.table import UnreadableTrajectory
from app.trajectories.trajectory import Array

# Rounded to seven digits, a covariance of rank below 6 may have eigenvalues a little below 0, no more.
NEGATIVE = 1e-5  # of the trace


def check_definite(covariances: Array, refuse: Callable[[int, str], UnreadableTrajectory]) -> None:
    """See that covariances, shape (N, M, M), have no negative eigenvalue.

    Parameters
    ----------
    covariances : ndarray of shape (N, M, M)
    refuse : callable
        Takes a row and what is wrong to the error that points at it.

    Raises
    ------
    UnreadableTrajectory
    """
    least = np.linalg.eigvalsh(covariances).min(axis=1)
    wrong = np.flatnonzero(least < -NEGATIVE * np.trace(covariances, axis1=1, axis2=2))
    if len(wrong):
        raise refuse(int(wrong[0]), "the covariance has a negative eigenvalue; no such errors exist")
