"""How far the dots of plates stand from their homographies, and what covariances that speaks for."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.homographies import image_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@compiled("void(float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1], boolean[:, ::1], float64[::1])")
def sum_squares(image_from_plate: Array, plate_u: Array, centres_px: Array, measured: Mask, squares_px2: Array) -> None:
    """Squared distances of the measured dots from where their plates' homographies put them, summed, (P,), written."""
    for plate in range(len(centres_px)):
        squares_px2[plate] = 0.0
        for dot in range(DOT_COUNT):
            if measured[plate, dot]:
                x, y = image_of(image_from_plate[plate], plate_u[dot, 0], plate_u[dot, 1])
                along, down = centres_px[plate, dot, 0] - x, centres_px[plate, dot, 1] - y
                squares_px2[plate] += along * along + down * down


@compiled("void(float64[:, :, :, ::1], float64[:, :, :, ::1], float64, float64, float64[:, :, :, ::1])")
def to_pixels(covariances_u2: Array, px_by_u: Array, floor_u2: float, floor_px2: float, written_px2: Array) -> None:
    """Covariances in pixels, shape (P, 16, 2, 2), written, with a floor in plate coordinates and one in pixels."""
    for plate in range(len(covariances_u2)):
        for dot in range(DOT_COUNT):
            inner, by = covariances_u2[plate, dot], px_by_u[plate, dot]
            xx, yy = inner[0, 0] + floor_u2, inner[1, 1] + floor_u2
            xy, yx = inner[0, 1], inner[1, 0]
            for row in range(2):
                first = by[row, 0] * xx + by[row, 1] * yx
                second = by[row, 0] * xy + by[row, 1] * yy
                for column in range(2):
                    written_px2[plate, dot, row, column] = first * by[column, 0] + second * by[column, 1]
                written_px2[plate, dot, row, row] += floor_px2


@compiled(
    "void(float64[:, :, ::1], float64[:, ::1], Tuple((float64[:, :, ::1], float64[:, :, :, ::1], boolean[:, ::1])), "
    "float64[::1])"
)
def sum_normalised_squares(
    image_from_plate: Array, plate_u: Array, dots: tuple[Array, Array, Mask], squares: Array
) -> None:
    """The same in units of the dots' covariances; ``dots`` are centres, covariances (px^2) and which are measured."""
    centres_px, covariances_px2, measured = dots
    for plate in range(len(centres_px)):
        squares[plate] = 0.0
        for dot in range(DOT_COUNT):
            if measured[plate, dot]:
                x, y = image_of(image_from_plate[plate], plate_u[dot, 0], plate_u[dot, 1])
                along, down = centres_px[plate, dot, 0] - x, centres_px[plate, dot, 1] - y
                c = covariances_px2[plate, dot]
                weighted = c[1, 1] * along * along - (c[0, 1] + c[1, 0]) * along * down + c[0, 0] * down * down
                squares[plate] += weighted / (c[0, 0] * c[1, 1] - c[0, 1] * c[1, 0])
