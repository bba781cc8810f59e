"""Sums over a dot's pixels that its place is solved from: derivatives by the place, and what grey values lack.

Beside its coordinates a dot has an amplitude and a background in luma and both chromas. What its neighbours and the
paper throw into its pixels is known from the plate's fit.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.dot_pixels import LIE, disc_at, to_plate
from app.vision.kernels.profiles import edge_profiles, grey_values
from app.vision.kernels.stray_light import PLATE, Plate, add_stray_light, set_black

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices32 = npt.NDArray[np.int32]

ROWS = 3  # luma and two chromas
# Of products, with x, y for the derivatives by the place, s for the share, r for what is missing, and 1:
SUMS = 14  # xx, xy, yy, xs, ys, ss, x, y, s, 1, rx, ry, rs, r
# Rows of a dot's pixels: offsets along x and y; grey values; share of the dot's light and its change along x and y;
# other light; room for a neighbour's profile. In the end there stands, in luma and both chromas, what grey values have
# above those expected, and instead of light the factor that takes the profile to a derivative.
OFFSETS, GREY, PROFILE, LIGHT, STRAY, PIXEL_ROWS = 0, 2, 5, 8, 11, 14
TABLES = "Tuple((float32[:, ::1], float32[::1], float32[:, ::1]))"
Tables = tuple[Array32, Array32, Array32]


@compiled("void(float64[::1], float32[::1], int64, float32[:, ::1])")
def _compare(amplitude: Array, curve: Array32, count: int, pixels: Array32) -> None:
    """Replace grey values by what they have above those expected, and light by the derivatives by the profile."""
    share, slopes = pixels[PROFILE], pixels[STRAY]
    for channel in range(3):
        each, light, grey = np.float32(amplitude[channel]), pixels[LIGHT + channel], pixels[GREY + channel]
        for at in range(count):
            light[at] += each * share[at]
        grey_values(curve, count, light, slopes)
        for at in range(count):
            grey[at] -= light[at]
            light[at] = slopes[at] * each


@compiled("void(float32[:, ::1], int64, int64, float32[:, ::1])")
def _to_luma_and_chroma(ycc_from_bgr: Array32, first: int, count: int, pixels: Array32) -> None:
    """Three rows of blue, green and red, in place."""
    m = ycc_from_bgr
    for at in range(count):
        blue, green, red = pixels[first, at], pixels[first + 1, at], pixels[first + 2, at]
        pixels[first, at] = m[0, 0] * blue + m[0, 1] * green + m[0, 2] * red
        pixels[first + 1, at] = m[1, 0] * blue + m[1, 1] * green + m[1, 2] * red
        pixels[first + 2, at] = m[2, 0] * blue + m[2, 1] * green + m[2, 2] * red


@compiled("void(float32[:, ::1], int64, int64, float64[::1])")
def _sum_up(pixels: Array32, count: int, line: int, sums: Array) -> None:
    """Sums of products over a dot's pixels, in luma or a chroma."""
    zero = np.float32(0.0)
    xx, xy, yy, xs, ys, ss, x, y, s = zero, zero, zero, zero, zero, zero, zero, zero, zero
    rx, ry, rs, r = zero, zero, zero, zero
    for at in range(count):
        factor, off = pixels[LIGHT + line, at], pixels[GREY + line, at]
        full, along = factor * pixels[PROFILE, at], factor * pixels[PROFILE + 1, at]
        down = factor * pixels[PROFILE + 2, at]
        xx, xy, yy = xx + along * along, xy + along * down, yy + down * down
        xs, ys, ss = xs + along * full, ys + down * full, ss + full * full
        x, y, s = x + along, y + down, s + full
        rx, ry, rs, r = rx + off * along, ry + off * down, rs + off * full, r + off
    for at, value in enumerate((xx, xy, yy, xs, ys, ss, x, y, s, np.float32(count), rx, ry, rs, r)):
        sums[at] = value


@compiled(f"void({LIE}, int64, {PLATE}, {TABLES}, Tuple((float32[:, ::1], int32[::1], float64[:, ::1])))")
def sum_dot(
    lie: tuple[float, ...], dot: int, plate: Plate, tables: Tables, room: tuple[Array32, Indices32, Array]
) -> None:
    """Write a dot's sums.

    Parameters
    ----------
    lie : tuple of float
        As ``lie_of`` gives it.
    dot : int
    plate : tuple
        The dots' light (16, 3); the planes of black and paper, constant and per u (3, 6); the standard deviation of the
        blur in px; and the farthest pixel in u.
    tables : tuple of ndarray
        As ``edge_profiles`` and ``grey_values`` take them; luma and chromas of blue, green, red (3, 3).
    room : tuple of ndarray
        Rows of N pixels, of which offsets in px and grey values are given; room for N numbers; the sums (3, SUMS).
    """
    edges, curve, ycc_from_bgr = tables
    pixels, places, sums = room
    amplitudes, planes, blur_px, _ = plate
    to_plate(lie, len(places), pixels)
    edge_profiles(pixels, disc_at(lie, (0.0, 0.0), blur_px), edges, places, pixels[PROFILE:LIGHT])
    lit = (pixels, places, pixels[STRAY:], pixels[LIGHT:STRAY])
    set_black(lie, planes, len(places), lit)
    add_stray_light(lie, dot, plate, edges, lit)
    _compare(amplitudes[dot], curve, len(places), pixels)
    for first in (GREY, LIGHT):
        _to_luma_and_chroma(ycc_from_bgr, first, len(places), pixels)
    for line in range(ROWS):
        _sum_up(pixels, len(places), line, sums[line])
