"""Where the dots of fitted plates stand."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT
from app.vision.kernels.homographies import image_of, px_by_u_at

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@compiled("UniTuple(float64, 3)(float64[::1], float64[:, ::1], float64[:, ::1])")
def _offset(amplitude: Array, slope: Array, ycc_from_bgr: Array) -> tuple[float, float, float]:
    """How far a dot stands from its place, x and y in u, and its squared amplitude.

    A disc moved by d adds ``amplitude * derivative . d`` in every channel: the least-squares ratio over luma and
    chroma, whose noise is independent.
    """
    power, x, y = 0.0, 0.0, 0.0
    for row in range(3):
        colour, along, down = 0.0, 0.0, 0.0
        for channel in range(3):
            colour += ycc_from_bgr[row, channel] * amplitude[channel]
            along += ycc_from_bgr[row, channel] * slope[0, channel]
            down += ycc_from_bgr[row, channel] * slope[1, channel]
        power += colour * colour
        x += along * colour
        y += down * colour
    power = max(power, 1.0)
    return x / power, y / power, power


@compiled("boolean(float64, float64, UniTuple(float64, 4), float64, UniTuple(int64, 2))")
def _is_inside(x: float, y: float, px_by_u: tuple[float, ...], border_u: float, size_px: tuple[int, int]) -> bool:
    """Whether a dot lies wholly in the photograph; it reaches as far along an axis as its derivatives are long."""
    reach_x = border_u * np.sqrt(px_by_u[0] ** 2 + px_by_u[1] ** 2)
    reach_y = border_u * np.sqrt(px_by_u[2] ** 2 + px_by_u[3] ** 2)
    return reach_x <= x <= size_px[0] - 1.0 - reach_x and reach_y <= y <= size_px[1] - 1.0 - reach_y


@compiled(
    "void(Tuple((float64[:, :, ::1], float64[:, :, ::1], float64[:, :, :, ::1], float64[::1], "
    "float64[:, :, :, ::1])), Tuple((float64[:, ::1], float64[:, ::1])), UniTuple(int64, 2), UniTuple(float64, 3), "
    "Tuple((float64[:, :, ::1], float64[:, :, :, ::1], float64[:, :, :, ::1], boolean[:, ::1], boolean[:, ::1])))"
)
def locate_all(
    fits: tuple[Array, ...],
    tables: tuple[Array, Array],
    size_px: tuple[int, int],
    bounds: tuple[float, float, float],
    dots: tuple[Array, Array, Array, Mask, Mask],
) -> None:
    """Centres, covariances and derivatives of all dots of P plates, written.

    Parameters
    ----------
    fits : tuple of ndarray
        Homographies (P, 3, 3), amplitudes (P, 16, 3), slopes (P, 16, 2, 3), what the fits left (P,), cofactors of the
        slopes (P, 16, 2, 2).
    tables : tuple of ndarray
        Dots in plate coordinates (16, 2); luma and chroma of blue, green, red (3, 3).
    size_px : tuple of int
        Width and height of the photograph.
    bounds : tuple of float
        Of ``CentreOptions`` offset_max_u, sigma_max_u, border_u.
    dots : tuple of ndarray, written
        The fields of ``DotCentres``; ``measured`` comes with the dots that show a colour and loses those that are
        uncertain or far off.
    """
    image_from_plate, amplitudes, slopes, residual_rms, cofactors = fits
    plate_u, ycc_from_bgr = tables
    centres_px, covariances_u2, px_by_u, measured, inside = dots
    offset_max_u, sigma_max_u, border_u = bounds
    for plate in range(len(image_from_plate)):
        homography = image_from_plate[plate]
        for dot in range(DOT_COUNT):
            x_u, y_u = plate_u[dot]
            dx, dy, power = _offset(amplitudes[plate, dot], slopes[plate, dot], ycc_from_bgr)
            near = abs(dx) < offset_max_u and abs(dy) < offset_max_u
            x, y = image_of(homography, x_u + dx, y_u + dy) if near else image_of(homography, x_u, y_u)
            derivatives = px_by_u_at(homography, x_u, y_u)
            variance = residual_rms[plate] ** 2 / power
            for row in range(2):
                for column in range(2):
                    covariances_u2[plate, dot, row, column] = variance * cofactors[plate, dot, row, column]
                    px_by_u[plate, dot, row, column] = derivatives[2 * row + column]
            mean = 0.5 * (covariances_u2[plate, dot, 0, 0] + covariances_u2[plate, dot, 1, 1])
            centres_px[plate, dot, 0], centres_px[plate, dot, 1] = x, y
            inside[plate, dot] = _is_inside(x, y, derivatives, border_u, size_px)
            certain = near and inside[plate, dot] and mean < sigma_max_u**2
            measured[plate, dot] = measured[plate, dot] and certain
