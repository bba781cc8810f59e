"""How sharply the red of a blob ends around it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.peaks import SMOOTH_PX

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]


@compiled("float64(uint8[:, ::1], float64, float64)")
def _average_at(redness: Pixels, x: float, y: float) -> float:
    """Average over the square around a place between pixels, bilinear; the picture's border goes on beyond it."""
    height, width = redness.shape
    left, top = int(np.floor(x)), int(np.floor(y))
    along, down = x - left, y - top
    total, reach = 0.0, SMOOTH_PX // 2
    for row in range(-reach, reach + 2):
        line = redness[min(max(top + row, 0), height - 1)]
        # The first and the last row, and column, count by their share.
        row_share = 1.0 - down if row == -reach else down if row == reach + 1 else 1.0
        for column in range(-reach, reach + 2):
            share = 1.0 - along if column == -reach else along if column == reach + 1 else 1.0
            total += row_share * share * line[min(max(left + column, 0), width - 1)]
    return total / SMOOTH_PX**2


@compiled("void(uint8[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1], float64, float64[::1])")
def measure_contrast(
    redness: Pixels, centres_px: Array, reach_px: Array, circle: Array, fraction: float, contrast: Array
) -> None:
    """By how much the red falls from the centre to a ring, grey values, written to ``contrast`` of shape (N,).

    Parameters
    ----------
    redness : ndarray of shape (H, W), uint8
    centres_px : ndarray of shape (N, 2)
    reach_px : ndarray of shape (N,)
        Radii of the rings.
    circle : ndarray of shape (M, 2)
        Points of a unit circle; the median of the ring's counts.
    fraction : float
        Of the centre's red, from which the fall is counted.
    """
    ring = np.empty(len(circle))
    for blob in range(len(centres_px)):
        x, y = centres_px[blob, 0], centres_px[blob, 1]
        for point in range(len(circle)):
            ring[point] = _average_at(
                redness, x + reach_px[blob] * circle[point, 0], y + reach_px[blob] * circle[point, 1]
            )
        contrast[blob] = fraction * _average_at(redness, x, y) - np.median(ring)
