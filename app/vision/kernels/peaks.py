"""Which pixels belong to the upper half of their own peak of redness.

Tile by tile, each with what stands around it laid out as one line of pixels of a length that the compiler knows: each
step is a plain loop along it, which runs on vector registers. What comes in at a row's end from the next row reaches
the margin only.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Pixels = npt.NDArray[np.uint8]
Sums = npt.NDArray[np.uint16]

TILE_ROWS, TILE_COLUMNS = 16, 64  # small enough to leave most of a picture out, long enough for vector registers
SMOOTH_PX = 3  # box that averages the redness: pixel noise must not break a dot or make one
# A dot ends where its redness falls to half the peak within this width, which holds a small dot and the gap beside it:
# the edge of a blurred disc, and what parts dots whose skirts touch.
PEAK_WINDOW_PX = 7

HALF_WINDOW_PX = PEAK_WINDOW_PX // 2
REACH_PX = SMOOTH_PX // 2 + HALF_WINDOW_PX
ROW = TILE_COLUMNS + 16  # of the tile with its surroundings; a multiple of a register's length
BLOCK = ROW * (TILE_ROWS + 2 * REACH_PX)
# One over the square's pixels, in parts of 2^16: with half of them added the product's upper half is rounded rightly.
SHARE = 2**16 // SMOOTH_PX**2 + 1
SPARE = 16  # pixels past the end that are read and mean nothing


@compiled("Tuple((uint8[:, ::1], uint16[::1]))()")
def room_for_tiles() -> tuple[Pixels, Sums]:
    """Room for a tile with its surroundings, three times, and for sums."""
    return np.zeros((3, BLOCK + 6 * ROW), dtype=np.uint8), np.zeros(BLOCK + SPARE, dtype=np.uint16)


@compiled("void(uint8[:, ::1], int64, int64, uint8[::1])")
def _load(redness: Pixels, top: int, left: int, block: Pixels) -> None:
    """Copy the tile with its surroundings; the picture's border pixels go on beyond it."""
    height, width = redness.shape
    inside = left >= 0 and left + ROW <= width
    for row in range(TILE_ROWS + 2 * REACH_PX):
        source, line = redness[min(max(top + row, 0), height - 1)], block[row * ROW :]
        if inside:
            part = source[left:]
            for x in range(ROW):
                line[x] = part[x]
        else:
            for x in range(ROW):
                line[x] = source[min(max(left + x, 0), width - 1)]


@compiled("void(uint8[::1], uint16[::1])")
def _smooth(block: Pixels, sums: Sums) -> None:
    """Average, in place, over the square of which each pixel is the first corner."""
    half, share = np.uint16(SMOOTH_PX**2 // 2), np.uint32(SHARE)
    second, third = block[ROW:], block[2 * ROW :]
    for x in range(BLOCK - 2 * ROW):
        sums[x] = np.uint16(block[x]) + np.uint16(second[x]) + np.uint16(third[x])
    next_sums, last_sums = sums[1:], sums[2:]
    for x in range(BLOCK - 2 * ROW):
        total = np.uint16(sums[x] + next_sums[x] + last_sums[x] + half)
        block[x] = np.uint8(np.uint32(total) * share >> np.uint32(16))


@compiled("void(uint8[::1], int64, uint8[::1])")
def _lift(pixels: Pixels, shift: int, lifted: Pixels) -> None:
    """Each pixel, or that so many further on if it is greater."""
    further = pixels[shift:]
    for x in range(BLOCK - 2 * ROW):
        lifted[x] = pixels[x] if pixels[x] > further[x] else further[x]


@compiled("void(uint8[:, ::1], uint8, UniTuple(int64, 2), Tuple((uint8[:, ::1], uint16[::1])), uint8[:, ::1])")
def mark_upper_half(
    redness: Pixels, floor: np.uint8, place: tuple[int, int], room: tuple[Pixels, Sums], marked: Pixels
) -> None:
    """Mark the pixels of a tile that stand above half their peak and above the floor.

    Parameters
    ----------
    redness : ndarray of shape (H, W), uint8
    floor : int
        Least average, grey values.
    place : tuple of int
        The tile's first pixel: row, column.
    room : tuple of ndarray
        What ``room_for_tiles`` gives: it serves one tile after the other.
    marked : ndarray of shape (16, columns), uint8, written from the tile's column on
    """
    smooth, one, other, sums, left = room[0][0], room[0][1], room[0][2], room[1], place[1]
    _load(redness, place[0] - REACH_PX, left - REACH_PX, smooth)
    _smooth(smooth, sums)
    # The greatest of seven from that of two and of four, down and along.
    _lift(smooth, ROW, one)
    _lift(one, 2 * ROW, other)
    _lift(other, 3 * ROW, one)
    _lift(one, 1, other)
    _lift(other, 2, one)
    _lift(one, 3, other)
    for row in range(TILE_ROWS):
        values, peaks = smooth[(row + HALF_WINDOW_PX) * ROW + HALF_WINDOW_PX :], other[row * ROW :]
        line = marked[row, left:]
        for x in range(TILE_COLUMNS):
            lacking = np.uint8(peaks[x] - values[x])
            bound = lacking if lacking > floor else floor
            line[x] = np.uint8(1) if values[x] > bound else np.uint8(0)
