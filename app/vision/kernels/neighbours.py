"""The nearest blobs of like size of each blob."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

NONE = -1


@compiled("void(float64, int64, float64[::1], int64[::1])")
def _insert(square: float, blob: int, squares: Array, nearest: Indices) -> None:
    """Put a blob in its place among the nearest, if it is one."""
    slot = len(squares) - 1
    if square >= squares[slot]:
        return
    while slot > 0 and squares[slot - 1] > square:
        squares[slot] = squares[slot - 1]
        nearest[slot] = nearest[slot - 1]
        slot -= 1
    squares[slot], nearest[slot] = square, blob


@compiled("void(float64[:, ::1], float64[:, ::1], float64, int64[:, ::1])")
def find_nearest(centres_px: Array, semi_axes_px: Array, area_ratio_max: float, nearest: Indices) -> None:
    """Indices of the nearest blobs of like size, nearest first, -1 where there are no more.

    Parameters
    ----------
    centres_px, semi_axes_px : ndarray of shape (N, 2)
    area_ratio_max : float
        Blobs whose areas differ by more are not looked at: specks do not use up a large dot's neighbours.
    nearest : ndarray of shape (N, K), written

    Notes
    -----
    Blobs are taken in the order of one coordinate, outwards from each until that coordinate alone is too far.
    """
    # Along the axis on which they spread more.
    axis = 0 if np.ptp(centres_px[:, 0]) > np.ptp(centres_px[:, 1]) else 1
    order = np.argsort(centres_px[:, axis])
    x, y = centres_px[order, axis], centres_px[order, 1 - axis]
    area = semi_axes_px[order, 0] * semi_axes_px[order, 1]
    squares = np.empty(nearest.shape[1])
    for place in range(len(order)):
        squares[:] = np.inf
        mine = nearest[order[place]]
        mine[:] = NONE
        for step in (-1, 1):
            other = place + step
            while 0 <= other < len(order):
                along = x[other] - x[place]
                if along * along >= squares[-1]:
                    break
                if area[other] < area_ratio_max * area[place] and area[place] < area_ratio_max * area[other]:
                    across = y[other] - y[place]
                    _insert(along * along + across * across, order[other], squares, mine)
                other += step
