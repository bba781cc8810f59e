"""Covariances of dots in pixels, as large as the dots of a photograph's plates scatter about their grids."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.homographies import image_of
from app.vision.kernels.misfits import HOMOGRAPHY_PARAMETERS

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@compiled("void(float64[:, :, ::1], float64[:, :, ::1], float64, float64, float64[:, :, ::1])")
def _to_pixels(covariances_u2: Array, px_by_u: Array, floor_u2: float, floor_px2: float, written_px2: Array) -> None:
    """Covariances of a plate's dots in pixels, written, with a floor in plate coordinates and one in pixels."""
    for dot in range(DOT_COUNT):
        inner, by = covariances_u2[dot], px_by_u[dot]
        xx, yy = inner[0, 0] + floor_u2, inner[1, 1] + floor_u2
        xy, yx = inner[0, 1], inner[1, 0]
        for row in range(2):
            first = by[row, 0] * xx + by[row, 1] * yx
            second = by[row, 0] * xy + by[row, 1] * yy
            for column in range(2):
                written_px2[dot, row, column] = first * by[column, 0] + second * by[column, 1]
            written_px2[dot, row, row] += floor_px2


@compiled("float64(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, :, ::1], boolean[::1])")
def _normalised_square(
    image_from_plate: Array, plate_u: Array, centres_px: Array, covariances_px2: Array, measured: Mask
) -> float:
    """Squared distances of a plate's dots from where its homography puts them, over their covariances, summed."""
    total = 0.0
    for dot in range(DOT_COUNT):
        if measured[dot]:
            x, y = image_of(image_from_plate, plate_u[dot, 0], plate_u[dot, 1])
            along, down = centres_px[dot, 0] - x, centres_px[dot, 1] - y
            c = covariances_px2[dot]
            weighted = c[1, 1] * along * along - (c[0, 1] + c[1, 0]) * along * down + c[0, 0] * down * down
            total += weighted / (c[0, 0] * c[1, 1] - c[0, 1] * c[1, 0])
    return total


@compiled("float64(float64[::1], float64, float64)")
def _factor(variances: Array, redundancy: float, prior_redundancy: float) -> float:
    """Variance of unit weight from those of single plates and a prior of 1; 1 without plates.

    The median keeps a bent plate from speaking for all.
    """
    if not len(variances):
        return 1.0
    return (redundancy * np.median(variances) + prior_redundancy) / (redundancy + prior_redundancy)


@compiled(
    "void(Tuple((float64[:, :, ::1], float64[:, ::1])), Tuple((float64[:, :, ::1], float64[:, :, :, ::1], "
    "float64[:, :, :, ::1], boolean[:, ::1])), Tuple((boolean[::1], boolean[::1])), UniTuple(float64, 4), "
    "float64[:, :, :, ::1])"
)
def scale_covariances(
    plates: tuple[Array, Array],
    dots: tuple[Array, Array, Array, Mask],
    which: tuple[Mask, Mask],
    bounds: tuple[float, ...],
    covariances_px2: Array,
) -> None:
    """Covariances of the dots of some plates, written into those of all, shape (P, 16, 2, 2), px^2.

    Parameters
    ----------
    plates : tuple of ndarray
        Homographies (P, 3, 3) through the dots; dots in plate coordinates (16, 2).
    dots : tuple of ndarray
        Of ``DotCentres`` centres, covariances (u^2), derivatives, which are measured.
    which : tuple of ndarray of shape (P,), bool
        The plates that are written; those of them that say how the dots scatter.
    bounds : tuple of float
        Least variance in plate coordinates and in pixels; ``CentreOptions`` prior_redundancy and unseen_factor.
    """
    (image_from_plate, plate_u), (centres_px, covariances_u2, px_by_u, measured) = plates, dots
    (mine, trusted), (floor_u2, floor_px2, prior_redundancy, unseen_factor) = which, bounds
    variances, count, total = np.empty(len(mine)), 0, 0.0
    for plate in np.flatnonzero(mine):
        _to_pixels(covariances_u2[plate], px_by_u[plate], floor_u2, floor_px2, covariances_px2[plate])
        redundancy = 2.0 * measured[plate].sum() - HOMOGRAPHY_PARAMETERS
        if trusted[plate] and redundancy > 0.0:
            where_px, sure_px2, seen = centres_px[plate], covariances_px2[plate], measured[plate]
            square = _normalised_square(image_from_plate[plate], plate_u, where_px, sure_px2, seen)
            variances[count] = square / redundancy
            count, total = count + 1, total + redundancy
    factor = _factor(variances[:count], total, prior_redundancy) * unseen_factor
    for plate in np.flatnonzero(mine):
        covariances_px2[plate] *= factor
