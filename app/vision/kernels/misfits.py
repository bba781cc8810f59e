"""How far the dots of plates stand from their homographies, and what covariances that speaks for."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.homographies import image_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

HOMOGRAPHY_PARAMETERS = 8


@compiled("float64(float64[:, ::1], float64[:, ::1], float64[:, ::1], boolean[::1])")
def misfit_of(image_from_plate: Array, plate_u: Array, centres_px: Array, measured: Mask) -> float:
    """Root mean square per coordinate of a plate's measured dots about its homography, px."""
    squares_px2, count = 0.0, 0
    for dot in range(DOT_COUNT):
        if measured[dot]:
            x, y = image_of(image_from_plate, plate_u[dot, 0], plate_u[dot, 1])
            along, down = centres_px[dot, 0] - x, centres_px[dot, 1] - y
            squares_px2 += along * along + down * down
            count += 1
    # A plate with few dots has little left to disagree.
    return np.sqrt(squares_px2 / max(2 * count - HOMOGRAPHY_PARAMETERS, 1))


@compiled("void(float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1], boolean[:, ::1], float64[::1])")
def measure_misfits(
    image_from_plate: Array, plate_u: Array, centres_px: Array, measured: Mask, misfits_px: Array
) -> None:
    """``misfit_of`` of many plates, shape (P,), written."""
    for plate in range(len(centres_px)):
        misfits_px[plate] = misfit_of(image_from_plate[plate], plate_u, centres_px[plate], measured[plate])
