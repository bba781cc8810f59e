"""Samples of plates on a grid in plate coordinates, in linear light.

Each step is a loop over all samples of a plate that runs on vector registers; only the four pixels around a sample are
fetched one by one, two at a time as the bytes of one number.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.homographies import image_of

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]
Words = npt.NDArray[np.uint64]
Pixels = npt.NDArray[np.uint8]

LIGHT_STEPS = 8  # of the table of linear light, per grey value: between pixels there are parts of grey values


@compiled("boolean(uint8[:, :, ::1], float64[:, ::1], float64)")
def _is_inside(level: Pixels, level_from_plate: Array, reach_u: float) -> bool:
    """Whether a patch's corners, and so the patch, have four pixels around each sample, and one more to the right."""
    height, width, _ = level.shape
    for corner in range(4):
        sign_x, sign_y = 1.0 if corner % 2 else -1.0, 1.0 if corner // 2 else -1.0
        x, y = image_of(level_from_plate, sign_x * reach_u, sign_y * reach_u)
        if not (x >= 0.0 and y >= 0.0 and x < width - 2.0 and y < height - 1.0):
            return False
    # A plate that reaches behind the camera has no such corners.
    along, down, middle = level_from_plate[2]
    return middle > reach_u * (abs(along) + abs(down))


@compiled("void(float64[:, ::1], float64[::1], int64, int64[::1], float32[:, ::1])")
def _place(level_from_plate: Array, axis_u: Array, stride: int, first: Indices, shares: Array32) -> None:
    """The first byte of the four pixels around each sample, and how far it stands to the right and below of it."""
    h, count = level_from_plate, len(axis_u)
    for row in range(count):
        x_by_row, y_by_row = h[0, 1] * axis_u[row] + h[0, 2], h[1, 1] * axis_u[row] + h[1, 2]
        depth_by_row = h[2, 1] * axis_u[row] + h[2, 2]
        line, along, down = first[row * count :], shares[0, row * count :], shares[1, row * count :]
        for column in range(count):
            share = 1.0 / (h[2, 0] * axis_u[column] + depth_by_row)
            x, y = (h[0, 0] * axis_u[column] + x_by_row) * share, (h[1, 0] * axis_u[column] + y_by_row) * share
            left, top = np.int64(x), np.int64(y)
            line[column] = top * stride + 3 * left
            along[column], down[column] = np.float32(x - left), np.float32(y - top)


@compiled("uint64(uint8[::1], uint64)")
def _word_at(pixels: Pixels, at: np.uint64) -> np.uint64:
    """Eight bytes as one number, the first the lowest: two pixels and what follows. The compiler makes it one load."""
    word = np.uint64(0)
    for byte in range(8):
        word |= np.uint64(pixels[at + np.uint64(byte)]) << np.uint64(8 * byte)
    return word


@compiled("void(uint8[::1], int64, int64[::1], uint64[:, ::1])")
def _fetch(pixels: Pixels, stride: int, first: Indices, words: Words) -> None:
    """The two pixels above each sample, and the two below."""
    above, below = words[0], words[1]
    for sample in range(len(first)):
        at = np.uint64(first[sample])
        above[sample] = _word_at(pixels, at)
        below[sample] = _word_at(pixels, at + np.uint64(stride))


@compiled("float32(uint64, uint64)")
def _byte_of(word: np.uint64, byte: np.uint64) -> np.float32:
    return np.float32(np.int32((word >> (np.uint64(8) * byte)) & np.uint64(255)))


@compiled("void(uint64[:, ::1], float32[:, ::1], float32[:, ::1])")
def _interpolate(words: Words, shares: Array32, samples: Array32) -> None:
    """Bilinear between two pixels above and two below."""
    above, below, along, down = words[0], words[1], shares[0], shares[1]
    for channel in range(3):
        left, right, line = np.uint64(channel), np.uint64(channel + 3), samples[channel]
        for sample in range(len(line)):
            upper, lower = _byte_of(above[sample], left), _byte_of(below[sample], left)
            upper += along[sample] * (_byte_of(above[sample], right) - upper)
            lower += along[sample] * (_byte_of(below[sample], right) - lower)
            line[sample] = upper + down[sample] * (lower - upper)


@compiled("void(float32[::1], int32[::1], float32[:, ::1])")
def _to_light(light: Array32, steps: npt.NDArray[np.int32], samples: Array32) -> None:
    """Coded grey values to linear light, in place."""
    for channel in range(3):
        line = samples[channel]
        for sample in range(len(line)):
            steps[sample] = np.int32(line[sample] * np.float32(LIGHT_STEPS) + np.float32(0.5))
        for sample in range(len(line)):
            line[sample] = light[np.uint32(steps[sample])]


@compiled("void(uint8[:, :, ::1], float64[:, ::1], float64[::1], float32[:, ::1])")
def _interpolate_clamped(level: Pixels, level_from_plate: Array, axis_u: Array, samples: Array32) -> None:
    """The same of a plate that may reach over the picture's border, which goes on beyond it."""
    height, width, _ = level.shape
    count = len(axis_u)
    for row in range(count):
        for column in range(count):
            x, y = image_of(level_from_plate, axis_u[column], axis_u[row])
            x = min(max(x, 0.0), width - 1.0) if x == x else 0.0
            y = min(max(y, 0.0), height - 1.0) if y == y else 0.0
            left, top = np.int64(x), np.int64(y)
            right, bottom = min(left + 1, width - 1), min(top + 1, height - 1)
            right_share, low_share = x - left, y - top
            for channel in range(3):
                upper = level[top, left, channel] * (1.0 - right_share) + level[top, right, channel] * right_share
                lower = level[bottom, left, channel] * (1.0 - right_share) + level[bottom, right, channel] * right_share
                samples[channel, row * count + column] = upper * (1.0 - low_share) + lower * low_share


@compiled(
    "void(uint8[:, :, ::1], float64[:, :, ::1], int64[::1], float64, float64[::1], float32[::1], float32[:, :, ::1])"
)
def sample_plates(
    level: Pixels,
    image_from_plate: Array,
    plates: Indices,
    factor: float,
    axis_u: Array,
    light: Array32,
    samples: Array32,
) -> None:
    """Sample some plates in a picture reduced by ``factor``.

    Parameters
    ----------
    level : ndarray of shape (H, W, 3), uint8
    image_from_plate : ndarray of shape (P, 3, 3)
    plates : ndarray of shape (M,)
        Indices of the plates to be sampled.
    factor : float
        Size of the level over that of the photograph.
    axis_u : ndarray of shape (N,)
        Coordinates of a square grid's columns and rows.
    light : ndarray of shape (255 * LIGHT_STEPS + 1,), float32
        Linear light by grey value.
    samples : ndarray of shape (P, 3, N * N), float32, written
        Blue, green, red, row by row.
    """
    level_from_plate, pixels, stride = np.empty((3, 3)), level.reshape(-1), 3 * level.shape[1]
    count = len(axis_u) ** 2
    first, words = np.empty(count, dtype=np.int64), np.empty((2, count), dtype=np.uint64)
    shares, steps = np.empty((2, count), dtype=np.float32), np.empty(count, dtype=np.int32)
    # Pixel centres stand at integers: the centre of a reduced pixel lies between those of its parts.
    shift = 0.5 * factor - 0.5
    for plate in plates:
        h = image_from_plate[plate]
        for column in range(3):
            level_from_plate[0, column] = factor * h[0, column] + shift * h[2, column]
            level_from_plate[1, column] = factor * h[1, column] + shift * h[2, column]
            level_from_plate[2, column] = h[2, column]
        if _is_inside(level, level_from_plate, axis_u[-1]):
            _place(level_from_plate, axis_u, stride, first, shares)
            _fetch(pixels, stride, first, words)
            _interpolate(words, shares, samples[plate])
        else:
            _interpolate_clamped(level, level_from_plate, axis_u, samples[plate])
        _to_light(light, steps, samples[plate])
