"""Plates solved under one template: samples to normal equations, normal equations to coefficients.

A dot and its derivatives are seen in a window around it, the background and the paper everywhere. All three channels
of a window are weighted in one loop of a length that fills whole vector registers.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.coefficients import BACKGROUND, CHANNELS, COEFFICIENTS, PER_DOT

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]

Template = tuple[Array32, Indices, Array32, Array, Array]


@compiled("void(float32[:, ::1], int64, int64[::1], float32[:, ::1])")
def _cut(samples: Array32, row_length: int, window: Indices, parts: Array32) -> None:
    """The samples of a window, channel by channel; what ``parts`` holds behind them keeps its weight of zero."""
    first, rows, columns = window
    for channel in range(CHANNELS):
        for row in range(rows):
            line, part = samples[channel, first + row * row_length :], parts[channel, row * columns :]
            for column in range(columns):
                part[column] = line[column]


@compiled("void(float32[:, ::1], float32[:, ::1], int64, float64[:, ::1])")
def _project_dot(parts: Array32, weights: Array32, column: int, right: Array) -> None:
    """Three channels times three weights, in one loop."""
    blue, green, red = parts[0], parts[1], parts[2]
    disc, along, down = weights[0], weights[1], weights[2]
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


@compiled("void(float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _solve(right: Array, cofactors: Array, solved: Array) -> None:
    """``right @ cofactors``, cofactors being symmetric."""
    blue, green, red = right[0], right[1], right[2]
    for coefficient in range(COEFFICIENTS):
        line = cofactors[coefficient]
        by_blue, by_green, by_red = 0.0, 0.0, 0.0
        for other in range(COEFFICIENTS):
            by_blue += blue[other] * line[other]
            by_green += green[other] * line[other]
            by_red += red[other] * line[other]
        solved[0, coefficient], solved[1, coefficient], solved[2, coefficient] = by_blue, by_green, by_red


@compiled(
    "void(float32[:, :, ::1], int64[::1], Tuple((float32[:, :, ::1], int64[:, ::1], float32[:, ::1], "
    "float64[:, ::1], float64[:, :, ::1])), Tuple((float64[:, :, ::1], float64[:, :, ::1], float64[:, :, :, ::1])))"
)
def solve_plates(samples: Array32, plates: Indices, template: Template, solution: tuple[Array, Array, Array]) -> None:
    """Coefficients of some plates under one template.

    Parameters
    ----------
    samples : ndarray of shape (P, 3, S), float32
    plates : ndarray of shape (M,)
        Indices of the plates to be solved.
    template : tuple of ndarray
        The fields of ``PlateTemplate``, in their order.
    solution : tuple of ndarray, written
        Right-hand sides and solutions of the normal equations (P, 3, 54), cofactors of the slopes (P, 16, 2, 2).
    """
    weights, windows, planes, cofactors, offset_cofactors = template
    right, solved, plate_cofactors = solution
    parts = np.zeros((CHANNELS, weights.shape[2]), dtype=np.float32)
    row_length = int(np.sqrt(planes.shape[1]))
    for plate in plates:
        for dot in range(DOT_COUNT):
            _cut(samples[plate], row_length, windows[dot], parts)
            _project_dot(parts, weights[dot], PER_DOT * dot, right[plate])
        for channel in range(CHANNELS):
            _project_planes(samples[plate, channel], planes, right[plate, channel, BACKGROUND:])
        _solve(right[plate], cofactors, solved[plate])
        plate_cofactors[plate] = offset_cofactors
