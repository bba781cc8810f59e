"""Parts of a photograph at a half, a quarter, ... of its size, for plates too large to be sampled in its own pixels."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.homographies import image_of

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]
Sums = npt.NDArray[np.uint16]

CHANNELS = 3
MARGIN_PX = 2  # what a sample takes from beyond its own place
Bounds = tuple[int, int]


@compiled("UniTuple(int64, 2)(float64, float64, int64)")
def _blocks_between(least: float, most: float, count: int) -> Bounds:
    """First block of a range of places, of so many, and the one after its last; two of them where there are two."""
    # Written so that a place that is no number, of a plate that reaches behind the camera, gives a block, too.
    first = int(min(np.floor(least), count - 1.0)) - MARGIN_PX if least > 0.0 else 0
    first = max(first, 0)
    last = int(min(np.ceil(most), count * 1.0)) + MARGIN_PX if most > 0.0 else 1
    return min(first, max(count - 2, 0)), min(max(last, first + 2), count)


@compiled("UniTuple(int64, 4)(float64[:, ::1], float64, int64, UniTuple(int64, 2))")
def blocks_around(image_from_plate: Array, reach_u: float, block: int, size: Bounds) -> tuple[int, int, int, int]:
    """Blocks, of ``size`` in all, that hold a plate's patch: first, past the last, first row, past the last row."""
    left, right, top, bottom = np.inf, -np.inf, np.inf, -np.inf
    for corner in range(4):
        x, y = image_of(image_from_plate, reach_u if corner % 2 else -reach_u, reach_u if corner // 2 else -reach_u)
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    first, last = _blocks_between(left / block, right / block, size[0])
    above, below = _blocks_between(top / block, bottom / block, size[1])
    return first, last, above, below


@compiled("void(uint8[::1], uint8[::1], uint16[::1], uint8[::1])")
def _halve_row(upper: Pixels, lower: Pixels, sums: Sums, half: Pixels) -> None:
    """Rounded means of two by two pixels."""
    for place in range(len(sums)):
        sums[place] = np.uint16(upper[place]) + np.uint16(lower[place])
    two = np.uint16(2)
    for x in range(len(half) // CHANNELS):
        for channel in range(CHANNELS):
            place = 2 * CHANNELS * x + channel
            total = np.uint16(np.uint16(sums[place] + sums[place + CHANNELS]) + two)
            half[CHANNELS * x + channel] = np.uint8(total >> two)


@compiled("uint8[:, :, ::1](uint8[:, :, ::1], UniTuple(int64, 4), int64)")
def halved(bgr: Pixels, blocks: tuple[int, int, int, int], halvings: int) -> Pixels:
    """The part of a photograph in some blocks of 2^halvings pixels a side, one pixel for each.

    Notes
    -----
    Halved time and again, each time rounded: so a pixel is the same, whatever part it is asked for with.
    """
    left, right, top, bottom = blocks
    scale = 1 << halvings
    columns, rows = (right - left) * scale, (bottom - top) * scale
    source, result = bgr, bgr
    sums = np.empty(CHANNELS * columns, dtype=np.uint16)
    first_row, first_byte = top * scale, CHANNELS * left * scale
    for _ in range(halvings):
        bytes_wide = CHANNELS * columns
        columns, rows = columns // 2, rows // 2
        result = np.empty((rows, columns, CHANNELS), dtype=np.uint8)
        for row in range(rows):
            upper = source[first_row + 2 * row].reshape(-1)[first_byte : first_byte + bytes_wide]
            lower = source[first_row + 2 * row + 1].reshape(-1)[first_byte : first_byte + bytes_wide]
            _halve_row(upper, lower, sums[:bytes_wide], result[row].reshape(-1))
        source, first_row, first_byte = result, 0, 0
    return result
