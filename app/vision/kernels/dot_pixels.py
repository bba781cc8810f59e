"""The pixels about a dot's edge: which they are, what they show and where they lie on the plate."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.homographies import image_of, px_by_u_at

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Words32 = npt.NDArray[np.uint32]
Pixels = npt.NDArray[np.uint8]
Room = tuple[Array32, Words32]

LIE = "UniTuple(float64, 10)"
ROOM = "Tuple((float32[:, ::1], uint32[::1]))"
HORIZON_MAX = 0.5  # of its depth: what a plate may recede by between a dot's middle and its farthest pixel


@compiled(f"{LIE}(float64[:, ::1], float64, float64)")
def lie_of(plate_from_image: Array, x_px: float, y_px: float) -> tuple[float, ...]:
    """How a plate lies about a dot: its pixel, its plate coordinates, their derivatives, and how the depth grows.

    With d the offset from the pixel, plate coordinates differ by exactly ``derivatives . d`` over ``1 + growth . d``.
    """
    h = plate_from_image
    share = 1.0 / (h[2, 0] * x_px + h[2, 1] * y_px + h[2, 2])
    x_u, y_u = image_of(h, x_px, y_px)
    xx, xy, yx, yy = px_by_u_at(h, x_px, y_px)
    return x_px, y_px, x_u, y_u, xx, xy, yx, yy, h[2, 0] * share, h[2, 1] * share


@compiled(f"float64({LIE}, float64, float64)")
def blur_factor(lie: tuple[float, ...], along: float, down: float) -> float:
    """What a blur that is round in the picture is along a direction of the plate, of unit length, u per px."""
    return np.hypot(along * lie[4] + down * lie[6], along * lie[5] + down * lie[7])


@compiled(f"UniTuple(float32, 7)({LIE}, UniTuple(float64, 2), float64)")
def disc_at(lie: tuple[float, ...], offset_u: tuple[float, float], blur_px: float) -> tuple[np.float32, ...]:
    """What ``edge_profiles`` must know of a disc that stands off a dot's middle."""
    _, _, _, _, xx, xy, yx, yy, _, _ = lie
    middle = np.float32(offset_u[0]), np.float32(offset_u[1])
    return *middle, np.float32(xx), np.float32(xy), np.float32(yx), np.float32(yy), np.float32(blur_px)


@compiled(f"UniTuple(int64, 3)({LIE}, float64, int64, int64)")
def window_of(lie: tuple[float, ...], reach_u: float, width: int, height: int) -> tuple[int, ...]:
    """First and last row, and the most pixels that ``collect`` takes; none of a plate nearly seen from its edge."""
    _, y_px, _, _, xx, xy, yx, yy, by_x, by_y = lie
    area = abs(xx * yy - xy * yx)
    reach_x, reach_y = reach_u * np.sqrt(yy * yy + xy * xy) / area, reach_u * np.sqrt(yx * yx + xx * xx) / area
    if not abs(by_x) * reach_x + abs(by_y) * reach_y < HORIZON_MAX:
        return 0, -1, 0
    top, bottom = max(int(np.ceil(y_px - reach_y)), 0), min(int(np.floor(y_px + reach_y)), height - 1)
    return top, bottom, max(bottom - top + 1, 0) * min(int(2.0 * reach_x) + 2, width)


@compiled("int64(uint8[::1], int64, UniTuple(float64, 2), UniTuple(int64, 3), Tuple((float32[:, ::1], uint32[::1])))")
def _take(line: Pixels, first_byte: int, offset: tuple[float, float], columns: tuple[int, int, int], room: Room) -> int:
    """Columns from the first up to the last of one row; ``offset`` is of column 0, and the third is what room has."""
    pixels, colours = room
    first, last, count = columns
    for column in range(first, last + 1):
        at = np.uint64(first_byte + 3 * column)
        # Four bytes as one number, the first the lowest: a pixel and what follows. The compiler makes it one load.
        colour = np.uint32(0)
        for byte in range(4):
            colour |= np.uint32(line[at + np.uint64(byte)]) << np.uint32(8 * byte)
        colours[count] = colour
        pixels[0, count], pixels[1, count] = np.float32(offset[0] + column), np.float32(offset[1])
        count += 1
    return count


@compiled(f"int64(uint8[:, :, ::1], {LIE}, UniTuple(int64, 3), UniTuple(float64, 2), {ROOM})")
def collect(
    bgr: Pixels, lie: tuple[float, ...], window: tuple[int, ...], ring_u: tuple[float, float], room: Room
) -> int:
    """Write the pixels of a ring about a dot's middle, and return their number.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    lie : tuple of float
        As ``lie_of`` gives it.
    window : tuple of int
        As ``window_of`` gives it for the outer radius.
    ring_u : tuple of float
        Inner and outer radius.
    room : tuple of ndarray
        Written: offsets from the dot's middle along x and y, px, float32 of shape (2, M); colours of shape (M,), a
        byte each of blue, green, red, from the lowest.
    """
    x_px, y_px, _, _, xx, xy, yx, yy, _, _ = lie
    # A circle on the plate is the ellipse a (x - shift y)^2 + rest y^2 = radius^2 in the picture.
    a, b = xx * xx + yx * yx, xx * xy + yx * yy
    shift, rest = -b / a, xy * xy + yy * yy - b * b / a
    inner2, outer2 = ring_u[0] * ring_u[0], ring_u[1] * ring_u[1]
    height, width, _ = bgr.shape
    line, count = bgr.reshape(-1), 0
    for row in range(window[0], window[1] + 1):
        y = row - y_px
        middle, inner, outer = x_px + shift * y, (inner2 - rest * y * y) / a, (outer2 - rest * y * y) / a
        half = np.sqrt(max(outer, 0.0))
        # The very last pixel has no fourth byte behind it.
        most = width - 1 if row < height - 1 else width - 2
        first, last = max(int(np.ceil(middle - half)), 0), min(int(np.floor(middle + half)), most)
        if inner > 0.0:
            hole = np.sqrt(inner)
            before, behind = int(np.ceil(middle - hole)) - 1, int(np.floor(middle + hole)) + 1
            count = _take(line, 3 * width * row, (-x_px, y), (first, min(before, last), count), room)
            first = max(first, behind)
        count = _take(line, 3 * width * row, (-x_px, y), (first, last, count), room)
    return count


@compiled("void(uint32[::1], int64, float32[:, ::1])")
def unpack(colours: Words32, count: int, greys: Array32) -> None:
    """Blue, green, red, shape (3, M), of colours as ``collect`` leaves them."""
    for channel in range(3):
        shift, line = np.uint32(8 * channel), greys[channel]
        for at in range(count):
            line[at] = np.float32(np.int32((colours[at] >> shift) & np.uint32(255)))


@compiled(f"void({LIE}, int64, float32[:, ::1])")
def to_plate(lie: tuple[float, ...], count: int, pixels: Array32) -> None:
    """Offsets in px (the first two rows) to offsets in plate coordinates, in place."""
    xx, xy, yx, yy = np.float32(lie[4]), np.float32(lie[5]), np.float32(lie[6]), np.float32(lie[7])
    by_x, by_y = np.float32(lie[8]), np.float32(lie[9])
    along, down = pixels[0], pixels[1]
    for at in range(count):
        x, y = along[at], down[at]
        share = np.float32(1.0) / (np.float32(1.0) + by_x * x + by_y * y)
        along[at], down[at] = (xx * x + xy * y) * share, (yx * x + yy * y) * share
