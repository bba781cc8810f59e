"""A plate's samples to the right-hand sides of its normal equations.

A dot and its derivatives are seen in a window around it, the background and the paper everywhere. All three channels
of a window are weighted in one loop of a length that fills whole vector registers.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.coefficients import BACKGROUND, CHANNELS, PER_DOT

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]

TEMPLATE = (
    "Tuple((float32[:, ::1], int64[:, :, ::1], float32[:, :, ::1], float64[:, :, ::1], float64[:, :, :, ::1], "
    "float64[:, :, ::1]))"
)
Template = tuple[Array32, Indices, Array32, Array, Array, Array]

WINDOW_STEP = 8  # columns: windows have a multiple of them, and are cut out so many at once
LOOP_STEP = 32  # samples: two registers of 16, which the compiler takes at once; a rest would be added one by one


@compiled("int64(int64)")
def whole_steps(count: int) -> int:
    """Rounded up to what loops take at once."""
    return -(-count // LOOP_STEP) * LOOP_STEP


@compiled("UniTuple(float32, 8)(float32[::1], uint64)")
def _eight_at(line: Array32, at: np.uint64) -> tuple[np.float32, ...]:
    """Eight samples at once: taken before any is put away, they are one load of the processor's."""
    a, b, c, d = line[at], line[at + np.uint64(1)], line[at + np.uint64(2)], line[at + np.uint64(3)]
    at += np.uint64(4)
    e, f, g, h = line[at], line[at + np.uint64(1)], line[at + np.uint64(2)], line[at + np.uint64(3)]
    return a, b, c, d, e, f, g, h


@compiled("void(float32[::1], int64, int64[::1], float32[::1])")
def _cut(samples: Array32, row_length: int, window: Indices, part: Array32) -> None:
    """The samples of a window; what ``part`` holds behind them has no weight."""
    first, rows, columns = window
    for left in range(0, columns, WINDOW_STEP):
        at, put = np.uint64(first + left), np.uint64(left)
        for _ in range(rows):
            values = _eight_at(samples, at)
            for place in range(WINDOW_STEP):
                part[put + np.uint64(place)] = values[place]
            at, put = at + np.uint64(row_length), put + np.uint64(columns)


@compiled("void(float32[:, ::1], float32[::1], int64, float64[:, ::1])")
def _project_dot(parts: Array32, weights: Array32, column: int, right: Array) -> None:
    """Three channels times three weights, in one loop."""
    blue, green, red = parts[0], parts[1], parts[2]
    length = len(weights) // PER_DOT
    disc, along, down = weights[:length], weights[length : 2 * length], weights[2 * length :]
    blue_disc = blue_along = blue_down = green_disc = green_along = green_down = np.float32(0.0)
    red_disc = red_along = red_down = np.float32(0.0)
    for sample in range(len(disc)):
        blue_disc += blue[sample] * disc[sample]
        blue_along += blue[sample] * along[sample]
        blue_down += blue[sample] * down[sample]
        green_disc += green[sample] * disc[sample]
        green_along += green[sample] * along[sample]
        green_down += green[sample] * down[sample]
        red_disc += red[sample] * disc[sample]
        red_along += red[sample] * along[sample]
        red_down += red[sample] * down[sample]
    right[0, column], right[0, column + 1], right[0, column + 2] = blue_disc, blue_along, blue_down
    right[1, column], right[1, column + 1], right[1, column + 2] = green_disc, green_along, green_down
    right[2, column], right[2, column + 1], right[2, column + 2] = red_disc, red_along, red_down


@compiled("void(float32[::1], float32[:, ::1], float64[::1])")
def _project_planes(line: Array32, planes: Array32, right: Array) -> None:
    """One channel times the background's and the paper's three columns each."""
    first, second, third = planes[0], planes[1], planes[2]
    fourth, fifth, sixth = planes[3], planes[4], planes[5]
    one = two = three = four = five = six = np.float32(0.0)
    for sample in range(len(line)):
        value = line[sample]
        one += value * first[sample]
        two += value * second[sample]
        three += value * third[sample]
        four += value * fourth[sample]
        five += value * fifth[sample]
        six += value * sixth[sample]
    right[0], right[1], right[2], right[3], right[4], right[5] = one, two, three, four, five, six


@compiled(f"void(float32[:, ::1], {TEMPLATE}, int64, float32[:, ::1], float64[:, ::1])")
def project_plate(samples: Array32, template: Template, level: int, parts: Array32, right: Array) -> None:
    """Right-hand sides of one plate's normal equations, shape (3, 54), written.

    Parameters
    ----------
    samples : ndarray of shape (3, S), float32
    template : tuple of ndarray
        The fields of ``TemplateShelf``, in their order.
    level : int
        Which of its templates.
    parts : ndarray of shape (3, W), float32
        Room for a window.
    """
    weights, windows, planes = template[0][level], template[1][level], template[2][level]
    row_length, length = int(np.sqrt(samples.shape[1])), whole_steps(windows[0, 1] * windows[0, 2])
    for dot in range(DOT_COUNT):
        for channel in range(CHANNELS):
            _cut(samples[channel], row_length, windows[dot], parts[channel])
        _project_dot(parts, weights[PER_DOT * length * dot : PER_DOT * length * (dot + 1)], PER_DOT * dot, right)
    for channel in range(CHANNELS):
        _project_planes(samples[channel], planes, right[channel, BACKGROUND:])
