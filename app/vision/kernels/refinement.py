"""Homographies through measured dots, by weighted least squares."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric
from app.targets.layout import DOT_COUNT
from app.vision.kernels.homographies import px_per_u_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

PARAMETERS = 8
# Points in line leave the plate's other direction open: a trace of a ridge keeps it finite, and the plate unlikely.
RIDGE = 1e-12
LEAST_DOTS = 5  # a homography takes four
LEAST_VARIANCE = 1e-300  # of dots without noise


@compiled("void(float64[:, ::1], float64[::1], float64[::1], float64, float64)")
def _add_row(normals: Array, right: Array, row: Array, observed: float, weight: float) -> None:
    for first in range(PARAMETERS):
        if row[first] != 0.0:
            right[first] += weight * row[first] * observed
            for second in range(first + 1):
                normals[first, second] += weight * row[first] * row[second]


@compiled("void(float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1])")
def fit_homography(plate_u: Array, image_px: Array, weights: Array, image_from_plate: Array) -> None:
    """The homography, shape (3, 3), written, of N points; its last element is 1.

    Parameters
    ----------
    plate_u, image_px : ndarray of shape (N, 2)
    weights : ndarray of shape (N,)
        0 leaves a point out; at least four points not in line must remain.
    """
    normals, right, row = np.zeros((PARAMETERS, PARAMETERS)), np.zeros(PARAMETERS), np.zeros(PARAMETERS)
    total, middle_x, middle_y = 0.0, 0.0, 0.0
    for point in range(len(weights)):
        total += weights[point]
        middle_x += weights[point] * image_px[point, 0]
        middle_y += weights[point] * image_px[point, 1]
    middle_x, middle_y = middle_x / total, middle_y / total
    for point in range(len(weights)):
        if weights[point] > 0.0:
            x, y = plate_u[point]
            for axis in range(2):
                observed = image_px[point, axis] - (middle_y if axis else middle_x)
                row[:] = 0.0
                row[3 * axis], row[3 * axis + 1], row[3 * axis + 2] = x, y, 1.0
                row[6], row[7] = -observed * x, -observed * y
                _add_row(normals, right, row, observed, weights[point])
    trace = 0.0
    for parameter in range(PARAMETERS):
        trace += normals[parameter, parameter]
    for parameter in range(PARAMETERS):
        normals[parameter, parameter] += RIDGE * trace
    solve_symmetric(normals, right)
    h = image_from_plate
    h[2, 0], h[2, 1], h[2, 2] = right[6], right[7], 1.0
    for column in range(3):
        # Undo the shift to the centroid.
        h[0, column] = right[column] + middle_x * h[2, column]
        h[1, column] = right[3 + column] + middle_y * h[2, column]


@compiled("void(float64[:, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1])")
def fit_all(plate_u: Array, image_px: Array, weights: Array, image_from_plate: Array) -> None:
    """``fit_homography`` of many plates: pixels (P, N, 2), weights (P, N), homographies (P, 3, 3)."""
    for plate in range(len(image_px)):
        fit_homography(plate_u, image_px[plate], weights[plate], image_from_plate[plate])


@compiled("int64(float64[:, :, ::1], float64[:, :, ::1], boolean[::1], float64[::1])")
def _weigh(covariances_u2: Array, px_by_u: Array, measured: Mask, weights: Array) -> int:
    """Weights of a plate's dots, written, 1 for the most precise in pixels; how many are measured."""
    least, count = np.inf, 0
    for dot in range(DOT_COUNT):
        inner, by = covariances_u2[dot], px_by_u[dot]
        area_px2 = abs(by[0, 0] * by[1, 1] - by[0, 1] * by[1, 0])
        weights[dot] = max(0.5 * (inner[0, 0] + inner[1, 1]) * area_px2, LEAST_VARIANCE)
        least = min(least, weights[dot])
        count += measured[dot]
    for dot in range(DOT_COUNT):
        weights[dot] = least / weights[dot] if measured[dot] else 0.0
    return count


@compiled(
    "void(float64[:, ::1], float64[:, :, ::1], Tuple((float64[:, :, ::1], float64[:, :, :, ::1], "
    "float64[:, :, :, ::1], boolean[:, ::1])), float64, float64[:, :, ::1])"
)
def refine_all(
    plate_u: Array, before: Array, dots: tuple[Array, Array, Array, Mask], rescale_max: float, refined: Array
) -> None:
    """Homographies, shape (P, 3, 3), written, through the measured dots, weighted by their precision.

    Parameters
    ----------
    plate_u : ndarray of shape (16, 2)
    before : ndarray of shape (P, 3, 3)
        What stays where too few dots were measured, or where they make the plate collapse.
    dots : tuple of ndarray
        Of ``DotCentres``: centres (px), covariances (u^2), derivatives, which are measured.
    rescale_max : float
        How many times larger or smaller a plate may become.
    refined : ndarray of shape (P, 3, 3), written
    """
    centres_px, covariances_u2, px_by_u, measured = dots
    weights = np.empty(DOT_COUNT)
    for plate in range(len(before)):
        if _weigh(covariances_u2[plate], px_by_u[plate], measured[plate], weights) >= LEAST_DOTS:
            fit_homography(plate_u, centres_px[plate], weights, refined[plate])
            now, then = px_per_u_of(refined[plate]), px_per_u_of(before[plate])
            # Dots in line leave the plate's other direction open: it collapses.
            if now < rescale_max * then and then < rescale_max * now:
                continue
        refined[plate] = before[plate]
