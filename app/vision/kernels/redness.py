"""How red each pixel is, and where that is worth a closer look."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.peaks import TILE_COLUMNS, TILE_ROWS

Pixels = npt.NDArray[np.uint8]


@compiled("void(uint8[::1], uint8[::1])")
def _raise(peak: Pixels, line: Pixels) -> None:
    """Lift each element of ``peak`` to that of ``line``."""
    for x in range(len(line)):
        peak[x] = line[x] if line[x] > peak[x] else peak[x]


@compiled("void(uint8[:, :, ::1], float32, float32, uint8, uint8[:, ::1], uint8[:, ::1])")
def measure_redness(
    bgr: Pixels, gain: np.float32, ratio: np.float32, floor: np.uint8, redness: Pixels, hot: Pixels
) -> None:
    """Redness of all pixels, and 1 for each tile that has some above the floor inside or one pixel around it.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    gain, ratio : float32
        Redness is ``gain * red - ratio * max(green, blue)``, 0 for all that is not red.
    floor : int
    redness : ndarray of shape (H, W), uint8, written
    hot : ndarray of shape (ceil(H / 16), ceil(W / 64)), uint8, written
    """
    height, width = redness.shape
    rows, columns = hot.shape
    half = np.float32(0.5)
    zero = np.float32(0.0)
    peak = np.zeros((rows, columns * TILE_COLUMNS), dtype=np.uint8)  # of each column of pixels within a tile
    for y in range(height):
        line = bgr[y].reshape(-1)
        red_line = redness[y]
        for x in range(width):
            blue, green, red = line[3 * x], line[3 * x + 1], line[3 * x + 2]
            other = green if green > blue else blue
            excess = gain * np.float32(red) - ratio * np.float32(other) + half
            excess = excess if excess > zero else zero
            excess = excess if excess < np.float32(255.0) else np.float32(255.0)
            red_line[x] = np.uint8(np.int32(excess))
        tile, inner = y // TILE_ROWS, y % TILE_ROWS
        _raise(peak[tile], red_line)
        if inner == 0 and tile > 0:
            _raise(peak[tile - 1], red_line)
        if inner == TILE_ROWS - 1 and tile + 1 < rows:
            _raise(peak[tile + 1], red_line)
    for row in range(rows):
        for column in range(columns):
            first, last = max(column * TILE_COLUMNS - 1, 0), min((column + 1) * TILE_COLUMNS + 1, width)
            hot[row, column] = 1 if peak[row, first:last].max() > floor else 0
