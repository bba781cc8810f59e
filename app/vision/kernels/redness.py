"""How red each pixel is, and where that is worth a closer look."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.peaks import TILE_COLUMNS, TILE_ROWS

Pixels = npt.NDArray[np.uint8]

# Gain and ratio come in parts of 1/128: with factors below 2 all products fit 16 bits.
SHARE_BITS = 7


def shares_of(factor: float) -> np.uint16:
    """A gain or ratio below 2 as the kernels take it."""
    return np.uint16(round(factor * (1 << SHARE_BITS)))


@compiled("void(uint8[::1], uint8[::1])")
def _raise(peak: Pixels, line: Pixels) -> None:
    """Lift each element of ``peak`` to that of ``line``."""
    for x in range(len(line)):
        peak[x] = line[x] if line[x] > peak[x] else peak[x]


@compiled("void(uint8[::1], uint16, uint16, uint8[::1])")
def redden(line: Pixels, gain: np.uint16, ratio: np.uint16, redness: Pixels) -> None:
    """Redness of a row of blue, green, red: whole numbers only, so that a register holds many pixels."""
    most, half, shift = np.uint16(255), np.uint16(1 << (SHARE_BITS - 1)), np.uint16(SHARE_BITS)
    for x in range(len(redness)):
        blue, green, red = line[3 * x], line[3 * x + 1], line[3 * x + 2]
        other = np.uint16(np.uint16(green if green > blue else blue) * ratio)
        own = np.uint16(np.uint16(red) * gain + half)
        over = own if own > other else other
        excess = np.uint16(np.uint16(over - other) >> shift)
        redness[x] = np.uint8(excess if excess < most else most)


@compiled("void(uint8[:, :, ::1], uint16, uint16, uint8, uint8[:, ::1], uint8[:, ::1])")
def measure_redness(
    bgr: Pixels, gain: np.uint16, ratio: np.uint16, floor: np.uint8, redness: Pixels, hot: Pixels
) -> None:
    """Redness of all pixels, and 1 for each tile that has some above the floor inside or one pixel around it.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    gain, ratio : int
        Redness is ``gain * red - ratio * max(green, blue)``, 0 for all that is not red; in shares of 1/128, below 2.
    floor : int
    redness : ndarray of shape (H, W), uint8, written
    hot : ndarray of shape (ceil(H / 16), ceil(W / 64)), uint8, written
    """
    height, width = redness.shape
    rows, columns = hot.shape
    peak = np.zeros((rows, columns * TILE_COLUMNS), dtype=np.uint8)  # of each column of pixels within a tile
    for y in range(height):
        red_line = redness[y]
        redden(bgr[y].reshape(-1), gain, ratio, red_line)
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
