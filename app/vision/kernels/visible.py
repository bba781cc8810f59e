"""Template fits of plates by the samples in sight.

What is hidden of a plate is taken out of the normal equations of its whole template: of the samples that are left out
there are fewer, and each shows a few dots only.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.coefficients import (
    BACKGROUND,
    CHANNELS,
    COEFFICIENTS,
    PAPER,
    PER_DOT,
    sort_coefficients,
    unexplained_in_sight,
)
from app.vision.kernels.factors import factorise, invert_lower, solve_by_inverse
from app.vision.kernels.projection import TEMPLATE, Template, project_plate, whole_steps

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]


@compiled("int64(float32[::1], int64[:, ::1], UniTuple(int64, 2), int64[::1], float64[::1])")
def _dots_of_row(weights: Array32, windows: Indices, place: tuple[int, int], columns: Indices, values: Array) -> int:
    """The dots' coefficients that a sample, at a row and a column, has a part in, written in order; how many."""
    high, wide = windows[0, 2], windows[0, 3]
    length, count = whole_steps(high * wide), 0
    for dot in range(DOT_COUNT):
        down, along = place[0] - windows[dot, 0], place[1] - windows[dot, 1]
        if 0 <= down < high and 0 <= along < wide:
            at = PER_DOT * length * dot + down * wide + along
            for part in range(PER_DOT):
                columns[count], values[count] = PER_DOT * dot + part, weights[at + part * length]
                count += 1
    return count


@compiled("int64(float32[:, ::1], int64, int64, int64[::1], float64[::1])")
def _planes_of_row(planes: Array32, sample: int, count: int, columns: Indices, values: Array) -> int:
    """The same of the background and the paper, behind so many others; how many in all."""
    for plane in range(COEFFICIENTS - BACKGROUND):
        if planes[plane, sample] != 0.0:
            columns[count], values[count] = BACKGROUND + plane, planes[plane, sample]
            count += 1
    return count


@compiled("void(int64[::1], float64[::1], float64[:, ::1])")
def _take_out(columns: Indices, values: Array, normals: Array) -> None:
    """The products of a sample's part in the coefficients, from the lower triangle of the normal matrix."""
    for first in range(len(columns)):
        line, value = normals[columns[first]], values[first]
        for second in range(first + 1):
            line[columns[second]] -= value * values[second]


@compiled(f"void({TEMPLATE}, int64, boolean[::1], float64[:, ::1], float64[::1])")
def _leave_out(template: Template, level: int, seen: Mask, normals: Array, discs: Array) -> None:
    """Take the samples out of sight from the lower triangle of the normal matrix, and from the sums of the discs."""
    weights, planes, side = template[0][level], template[2][level], int(np.sqrt(len(seen)))
    columns, values = np.empty(COEFFICIENTS, dtype=np.int64), np.empty(COEFFICIENTS)
    windows = np.empty((DOT_COUNT, 4), dtype=np.int64)  # first row and column, rows, columns
    for dot in range(DOT_COUNT):
        first, windows[dot, 2], windows[dot, 3] = template[1][level, dot]
        windows[dot, 0], windows[dot, 1] = divmod(first, side)
    for row in range(side):
        for column in range(side):
            if seen[row * side + column]:
                continue
            count = _dots_of_row(weights, windows, (row, column), columns, values)
            for disc in range(0, count, PER_DOT):
                discs[columns[disc] // PER_DOT] -= values[disc]
            count = _planes_of_row(planes, row * side + column, count, columns, values)
            _take_out(columns[:count], values[:count], normals)


@compiled(f"void({TEMPLATE}, int64, float64[::1])")
def _sum_discs(template: Template, level: int, discs: Array) -> None:
    """Sum of each dot's disc over all samples."""
    weights, windows = template[0][level], template[1][level]
    length = whole_steps(windows[0, 1] * windows[0, 2])
    for dot in range(DOT_COUNT):
        total = np.float32(0.0)
        for value in weights[PER_DOT * length * dot : PER_DOT * length * dot + length]:
            total += value
        discs[dot] = total


@compiled("int64(float32[:, ::1], boolean[::1], float32[:, ::1])")
def _keep_seen(samples: Array32, seen: Mask, kept: Array32) -> int:
    """The samples in sight, and 0 in place of the others; how many are in sight."""
    count = 0
    for sample in range(len(seen)):
        count += seen[sample]
    for channel in range(CHANNELS):
        for sample in range(len(seen)):
            kept[channel, sample] = samples[channel, sample] if seen[sample] else np.float32(0.0)
    return count


@compiled("void(float64[:, ::1], float64[:, :, ::1])")
def _dot_cofactors(inverse: Array, cofactors: Array) -> None:
    """Of each dot's two derivatives, (16, 2, 2), from the inverse of the normal matrix's factor."""
    for dot in range(DOT_COUNT):
        first = PER_DOT * dot + 1
        xx = xy = yy = 0.0
        for row in range(first, COEFFICIENTS):
            along, down = inverse[row, first], inverse[row, first + 1]
            xx += along * along
            xy += along * down
            yy += down * down
        cofactors[dot, 0, 0], cofactors[dot, 0, 1], cofactors[dot, 1, 0], cofactors[dot, 1, 1] = xx, xy, xy, yy


@compiled(
    f"void(float32[:, :, ::1], boolean[:, ::1], int64[::1], {TEMPLATE}, UniTuple(float64, 4), "
    "Tuple((float64[:, :, ::1], float64[:, :, :, ::1], float64[:, :, ::1], float64[::1], float64[::1], "
    "float64[:, :, :, ::1], float64[:, ::1])))"
)
def fit_seen(
    samples: Array32,
    seen: Mask,
    levels: Indices,
    template: Template,
    known: tuple[float, float, float, float],
    fits: tuple[Array, ...],
) -> None:
    """Fit P plates.

    Parameters
    ----------
    samples : ndarray of shape (P, 3, S), float32
    seen : ndarray of shape (P, S)
        Which samples are in sight.
    levels : ndarray of shape (P,)
        Which template each plate takes.
    template : tuple of ndarray
        The fields of ``TemplateShelf``, in their order.
    known : tuple of float
        The ridge on all coefficients but the paper's; that on the paper's, per sample in sight; how far a patch
        reaches, u; of how much of a dot that is in sight its colour is told, 0 else.
    fits : tuple of ndarray, written
        Of ``PlateFits`` amplitudes, slopes, planes, residual_rms, spread_rms, offset_cofactors; and, of shape (P, 16),
        the part of each dot that is in sight.
    """
    amplitudes, slopes, planes, residual_rms, spread_rms, offset_cofactors, shares = fits
    right, solved = np.empty((CHANNELS, COEFFICIENTS)), np.empty((CHANNELS, COEFFICIENTS))
    normals, inverse = np.empty((COEFFICIENTS, COEFFICIENTS)), np.empty((COEFFICIENTS, COEFFICIENTS))
    begins = np.empty(COEFFICIENTS, dtype=np.int64)
    kept, discs = np.empty(samples.shape[1:], dtype=np.float32), np.empty(DOT_COUNT)
    parts = np.zeros((CHANNELS, whole_steps(samples.shape[2])), dtype=np.float32)
    for plate in range(len(samples)):
        level = levels[plate]
        normals[:] = template[5][level]
        _sum_discs(template, level, discs)
        shares[plate] = discs
        _leave_out(template, level, seen[plate], normals, discs)
        for dot in range(DOT_COUNT):
            shares[plate, dot] = discs[dot] / shares[plate, dot]
        count = _keep_seen(samples[plate], seen[plate], kept)
        project_plate(kept, template, level, parts, right)
        ridges = (known[0], known[1] * count)
        for place in range(COEFFICIENTS):
            normals[place, place] += ridges[1] if place >= PAPER else ridges[0]
        factorise(normals, begins)
        invert_lower(normals, begins, inverse)
        solve_by_inverse(inverse, right, solved)
        residual_rms[plate], spread_rms[plate] = unexplained_in_sight(kept, right, solved, ridges, count)
        sort_coefficients(solved, known[2], amplitudes[plate], slopes[plate], planes[plate])
        _dot_cofactors(inverse, offset_cofactors[plate])
        for dot in range(DOT_COUNT):
            if shares[plate, dot] < known[3]:
                amplitudes[plate, dot], slopes[plate, dot] = 0.0, 0.0
