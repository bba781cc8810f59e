"""Samples of plates on a grid in plate coordinates, in linear light.

Each step is a loop over all samples of a plate that runs on vector registers; only the four pixels around a sample are
fetched one by one, two at a time as the bytes of one number.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.halving import blocks_around, halved
from app.vision.kernels.homographies import image_of, px_per_u_of

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]
Indices32 = npt.NDArray[np.int32]
Words = npt.NDArray[np.uint64]
Pixels = npt.NDArray[np.uint8]

LIGHT_DEGREE = 5  # of the polynomial that takes grey values to linear light: off by 0.007 of 255 at most
WORD_BYTES = 8


@compiled("int64(float64, int64)")
def _pixel_near(place: float, count: int) -> int:
    """The pixel before a place, of so many; any of them for a plate that reaches behind the camera."""
    return int(min(place, count - 1.0)) if place > 0.0 else 0


@compiled("UniTuple(int64, 2)(float64[:, ::1], float64, UniTuple(int64, 2), float64[:, ::1])")
def _about_middle(image_from_plate: Array, factor: float, size: tuple[int, int], about: Array) -> tuple[int, int]:
    """The plate's middle pixel (x, y) in the reduced picture, and, written, the homography to offsets from it.

    Of offsets, unlike pixels of a large picture, single precision keeps 1e-5.
    """
    # Pixel centres stand at integers: the centre of a reduced pixel lies between those of its parts.
    h, shift = image_from_plate, 0.5 * factor - 0.5
    x, y = image_of(h, 0.0, 0.0)
    left, top = _pixel_near(factor * x + shift, size[0]), _pixel_near(factor * y + shift, size[1])
    for column in range(3):
        depth = h[2, column] / h[2, 2]
        about[0, column] = factor * h[0, column] / h[2, 2] + (shift - left) * depth
        about[1, column] = factor * h[1, column] / h[2, 2] + (shift - top) * depth
        about[2, column] = depth
    return left, top


@compiled("UniTuple(float32, 2)(float32, float32, float32)")
def _before(place: np.float32, least: np.float32, most: np.float32) -> tuple[np.float32, np.float32]:
    """The pixel before a place, and how far the place stands behind it; the picture's border goes on beyond it."""
    kept = place if place > least else least  # so for NaN, too
    kept = kept if kept < most else most
    pixel = min(np.floor(kept), most - np.float32(1.0))
    return pixel, kept - pixel


@compiled("void(float64[:, ::1], float64[::1], UniTuple(float32, 4), int64, Tuple((int32[::1], float32[:, ::1])))")
def _place(
    h: Array, axis_u: Array, bounds: tuple[np.float32, ...], stride: int, room: tuple[Indices32, Array32]
) -> None:
    """The first byte of the four pixels around each sample, and how far it stands to the right and below of it."""
    first, shares = room
    least_x, most_x, least_y, most_y = bounds
    x_by_u, y_by_u, depth_by_u = np.float32(h[0, 0]), np.float32(h[1, 0]), np.float32(h[2, 0])
    count, row_bytes = len(axis_u), np.int32(stride)
    for row in range(count):
        v = axis_u[row]
        x_by_row, y_by_row = np.float32(h[0, 1] * v + h[0, 2]), np.float32(h[1, 1] * v + h[1, 2])
        depth_by_row = np.float32(h[2, 1] * v + h[2, 2])
        line, along, down = first[row * count :], shares[0, row * count :], shares[1, row * count :]
        for column in range(count):
            u = np.float32(axis_u[column])
            share = np.float32(1.0) / (depth_by_u * u + depth_by_row)
            left, along[column] = _before((x_by_u * u + x_by_row) * share, least_x, most_x)
            top, down[column] = _before((y_by_u * u + y_by_row) * share, least_y, most_y)
            line[column] = np.int32(top) * row_bytes + np.int32(3) * np.int32(left)


@compiled("uint64(uint8[::1], uint64)")
def _word_at(pixels: Pixels, at: np.uint64) -> np.uint64:
    """Eight bytes as one number, the first the lowest: two pixels and what follows. The compiler makes it one load."""
    word = np.uint64(0)
    for byte in range(WORD_BYTES):
        word |= np.uint64(pixels[at + np.uint64(byte)]) << np.uint64(8 * byte)
    return word


@compiled("void(uint8[::1], int64, int64, int32[::1], uint64[:, ::1])")
def _fetch(pixels: Pixels, middle: int, stride: int, first: Indices32, words: Words) -> None:
    """The two pixels above each sample, and the two below; ``first`` counts bytes from the middle's."""
    above, below, last = words[0], words[1], np.uint64(len(pixels) - WORD_BYTES)
    for sample in range(len(first)):
        at = np.uint64(middle + first[sample])
        above[sample] = _word_at(pixels, at)
        at += np.uint64(stride)
        # Behind the picture's last two pixels there are no more bytes.
        begin = min(at, last)
        below[sample] = _word_at(pixels, begin) >> (np.uint64(8) * (at - begin))


@compiled("float32(uint64, uint64)")
def _byte_of(word: np.uint64, byte: np.uint64) -> np.float32:
    return np.float32(np.int32((word >> (np.uint64(8) * byte)) & np.uint64(255)))


@compiled("void(uint64[:, ::1], float32[:, ::1], float32[::1], float32[:, ::1])")
def _interpolate(words: Words, shares: Array32, light: Array32, samples: Array32) -> None:
    """Bilinear between two pixels above and two below, then coded grey values to linear light."""
    above, below, along, down = words[0], words[1], shares[0], shares[1]
    one, g1, g2, g3, g4, g5, begins, straight = light
    for channel in range(3):
        left, right, line = np.uint64(channel), np.uint64(channel + 3), samples[channel]
        for sample in range(len(line)):
            upper, lower = _byte_of(above[sample], left), _byte_of(below[sample], left)
            upper += along[sample] * (_byte_of(above[sample], right) - upper)
            lower += along[sample] * (_byte_of(below[sample], right) - lower)
            grey = upper + down[sample] * (lower - upper)
            bent = one + grey * (g1 + grey * (g2 + grey * (g3 + grey * (g4 + grey * g5))))
            line[sample] = straight * grey if grey < begins else bent


@compiled(
    "void(uint8[:, :, ::1], float64[:, ::1], float64, Tuple((float64[::1], float32[::1])), "
    "Tuple((int32[::1], uint64[:, ::1], float32[:, ::1])), float32[:, ::1])"
)
def _sample(
    level: Pixels,
    image_from_plate: Array,
    factor: float,
    tables: tuple[Array, Array32],
    room: tuple[Indices32, Words, Array32],
    samples: Array32,
) -> None:
    """Sample a plate in a picture reduced by ``factor``, of two pixels each way at least."""
    height, width, _ = level.shape
    about, stride, (first, words, shares) = np.empty((3, 3)), 3 * width, room
    x, y = _about_middle(image_from_plate, factor, (width, height), about)
    bounds = (np.float32(-x), np.float32(width - 1 - x), np.float32(-y), np.float32(height - 1 - y))
    _place(about, tables[0], bounds, stride, (first, shares))
    _fetch(level.reshape(-1), stride * y + 3 * x, stride, first, words)
    _interpolate(words, shares, tables[1], samples)


@compiled("uint8[:, :, ::1](uint8[:, :, ::1])")
def _two_each_way(pixels: Pixels) -> Pixels:
    """The picture; one of a single row or column with that repeated, for samples are taken between two."""
    height, width, channels = pixels.shape
    if min(height, width) > 1:
        return pixels
    twice = np.empty((max(height, 2), max(width, 2), channels), dtype=np.uint8)
    for row in range(len(twice)):
        for column in range(twice.shape[1]):
            twice[row, column] = pixels[min(row, height - 1), min(column, width - 1)]
    return twice


@compiled("int64(float64, float64, int64)")
def _halvings_for(px_per_u: float, px_per_u_max: float, most: int) -> int:
    """How often a photograph is halved for a plate of such a size."""
    halvings = 0
    while halvings < most and px_per_u > px_per_u_max:
        px_per_u, halvings = 0.5 * px_per_u, halvings + 1
    return halvings


@compiled(
    "void(uint8[:, :, ::1], float64[:, :, ::1], Tuple((float64, int64, float64)), Tuple((float64[::1], "
    "float32[::1])), Tuple((float32[:, :, ::1], float64[::1], int64[::1])))"
)
def sample_plates(
    bgr: Pixels,
    image_from_plate: Array,
    bounds: tuple[float, int, float],
    tables: tuple[Array, Array32],
    written: tuple[Array32, Array, Indices],
) -> None:
    """Sample plates, each in the photograph halved as often as suits its size.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    image_from_plate : ndarray of shape (P, 3, 3)
    bounds : tuple
        Largest plate that is sampled in the photograph itself, px per u; most halvings; how far a patch reaches, u.
    tables : tuple of ndarray
        Coordinates (N,), u, of a square grid's columns and rows; linear light by grey value, shape
        (LIGHT_DEGREE + 3,), float32: factors of a polynomial; where it begins, and the slope of the line before.
    written : tuple of ndarray
        Blue, green, red, row by row, shape (P, 3, N * N), float32; scale at the plates' centres, px per u; halvings.
    """
    samples, px_per_u, halvings = written
    height, width, _ = bgr.shape
    whole, shifted, count = _two_each_way(bgr), np.empty((3, 3)), len(tables[0]) ** 2
    words, shares = np.empty((2, count), dtype=np.uint64), np.empty((2, count), dtype=np.float32)
    room = (np.empty(count, dtype=np.int32), words, shares)
    for plate in range(len(image_from_plate)):
        px_per_u[plate] = px_per_u_of(image_from_plate[plate])
        halvings[plate] = _halvings_for(px_per_u[plate], bounds[0], bounds[1])
        if halvings[plate] == 0:
            _sample(whole, image_from_plate[plate], 1.0, tables, room, samples[plate])
            continue
        block = 1 << halvings[plate]
        # Whole blocks only: an odd last row or column would shift the grid.
        blocks = blocks_around(image_from_plate[plate], bounds[2], block, (width // block, height // block))
        shifted[:] = image_from_plate[plate]
        for column in range(3):
            shifted[0, column] -= block * blocks[0] * shifted[2, column]
            shifted[1, column] -= block * blocks[2] * shifted[2, column]
        part = _two_each_way(halved(bgr, blocks, halvings[plate]))
        _sample(part, shifted, 1.0 / block, tables, room, samples[plate])
