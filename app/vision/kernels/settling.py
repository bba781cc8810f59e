"""Where dots stand, from every pixel about their edges: one step of least squares on the grey values themselves."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.dot_pixels import LIE, collect, lie_of, unpack, window_of
from app.vision.kernels.dot_sums import GREY, PIXEL_ROWS, ROWS, SUMS, TABLES, Tables, sum_dot

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]
Pixels = npt.NDArray[np.uint8]

PIXELS_FIRST = 256  # that there is room for to begin with
SINGULAR = 1e-6  # of a product of diagonals: a window that shows no background besides the dot
AMPLITUDE_MIN, AMPLITUDE_MAX = 0.3, 3.0  # of the plate's fit: beyond, that has seen another dot
PLATES = "Tuple((float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64))"
Plates = tuple[Array, Array, Array, float]
DOTS = "Tuple((boolean[:, ::1], float64[:, :, ::1], float64[:, :, :, ::1]))"


@compiled("void(float64[:, ::1], float64[::1], float64[::1])")
def _solve_place(sums: Array, weights: Array, written: Array) -> None:
    """Offset (x, y) and the upper triangle of its information, written, of one dot, in px and grey values.

    Amplitude and background are eliminated row by row; the derivatives, which the fit's amplitude was put into, are
    corrected for the dot's own.
    """
    xx, xy, yy, x, y = 0.0, 0.0, 0.0, 0.0, 0.0
    for line in range(ROWS):
        e = sums[line]
        e_xx, e_xy, e_yy, e_xs, e_ys, e_ss = e[0], e[1], e[2], e[3], e[4], e[5]
        e_x, e_y, e_s, count, r_x, r_y, r_s, r = e[6], e[7], e[8], e[9], e[10], e[11], e[12], e[13]
        determinant = e_ss * count - e_s * e_s
        if determinant <= SINGULAR * e_ss * count:
            continue
        # Amplitude and background that x, y and the residuals would take.
        x_s, x_b = (count * e_xs - e_s * e_x) / determinant, (e_ss * e_x - e_s * e_xs) / determinant
        y_s, y_b = (count * e_ys - e_s * e_y) / determinant, (e_ss * e_y - e_s * e_ys) / determinant
        r_amplitude, r_background = (count * r_s - e_s * r) / determinant, (e_ss * r - e_s * r_s) / determinant
        amplitude = min(max(1.0 + r_amplitude, AMPLITUDE_MIN), AMPLITUDE_MAX)
        power = weights[line] * amplitude * amplitude
        xx += power * (e_xx - e_xs * x_s - e_x * x_b)
        xy += power * (e_xy - e_xs * y_s - e_x * y_b)
        yy += power * (e_yy - e_ys * y_s - e_y * y_b)
        x += weights[line] * amplitude * (r_x - e_xs * r_amplitude - e_x * r_background)
        y += weights[line] * amplitude * (r_y - e_ys * r_amplitude - e_y * r_background)
    determinant = xx * yy - xy * xy
    written[2], written[3], written[4] = xx, xy, yy
    written[0] = (yy * x - xy * y) / determinant if determinant > 0.0 else 0.0
    written[1] = (xx * y - xy * x) / determinant if determinant > 0.0 else 0.0


@compiled(f"UniTuple(float64, 2)({LIE}, float64, float64[::1])")
def _ring(lie: tuple[float, ...], blur_px: float, limits: Array) -> tuple[float, float]:
    """Inner and outer radius of what shows a dot's edge, under the greatest of its blurs."""
    reach_u, blurs, chroma_px = limits
    # The greatest singular value of the derivatives, from the sum of their squares and their determinant.
    squares, area = lie[4] ** 2 + lie[5] ** 2 + lie[6] ** 2 + lie[7] ** 2, lie[4] * lie[7] - lie[5] * lie[6]
    most = np.sqrt(0.5 * (squares + np.sqrt(max(squares**2 - 4.0 * area**2, 0.0))))
    width_u = blurs * np.hypot(blur_px, chroma_px) * most
    return max(1.0 - width_u, 0.0), min(1.0 + width_u, reach_u)


@compiled(f"void({LIE}, float64[::1], float64[:, ::1], float64[::1], float64[:, ::1])")
def _move(lie: tuple[float, ...], found: Array, limits: Array, centre_px: Array, covariance_u2: Array) -> None:
    """Put a dot in its place, with the covariance to suit, unless its step is too long to be believed."""
    x, y, xx, xy, yy = found
    step_max_u, noise_grey, _ = limits[2]
    determinant = xx * yy - xy * xy
    if not determinant > 0.0:
        return
    u_by_x, u_by_y, v_by_x, v_by_y = lie[4], lie[5], lie[6], lie[7]
    if max(abs(u_by_x * x + u_by_y * y), abs(v_by_x * x + v_by_y * y)) >= step_max_u:
        return
    centre_px[0], centre_px[1] = lie[0] + x, lie[1] + y
    variance = noise_grey * noise_grey / determinant
    covariance_u2[0, 0] = variance * (yy * u_by_x * u_by_x - 2.0 * xy * u_by_x * u_by_y + xx * u_by_y * u_by_y)
    covariance_u2[1, 1] = variance * (yy * v_by_x * v_by_x - 2.0 * xy * v_by_x * v_by_y + xx * v_by_y * v_by_y)
    mixed = yy * u_by_x * v_by_x - xy * (u_by_x * v_by_y + u_by_y * v_by_x) + xx * u_by_y * v_by_y
    covariance_u2[0, 1] = covariance_u2[1, 0] = variance * mixed


@compiled("void(float64[:, ::1], float64[:, ::1])")
def _reverse(homography: Array, written: Array) -> None:
    """The reverse of a homography, up to its scale: the adjugate."""
    for row in range(3):
        below, last = (row + 1) % 3, (row + 2) % 3
        for column in range(3):
            right, far = (column + 1) % 3, (column + 2) % 3
            written[column, row] = (
                homography[below, right] * homography[last, far] - homography[below, far] * homography[last, right]
            )


@compiled(f"void(uint8[:, :, ::1], int64[::1], {PLATES}, Tuple(({TABLES}, float64[:, ::1])), {DOTS})")
def settle_all(
    bgr: Pixels, chosen: Indices, plates: Plates, known: tuple[Tables, Array], dots: tuple[Mask, Array, Array]
) -> None:
    """Move all measured dots of some of P plates.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    chosen : ndarray of shape (C,)
    plates : tuple
        Homographies from plate coordinates to pixels (P, 3, 3); the dots' light (P, 16, 3); the planes of black and
        paper, constant and per u (P, 3, 6); the standard deviation of the blur in px.
    known : tuple
        Tables as ``sum_dot`` takes them; and, shape (3, 3): how far about a dot pixels count in u, in blurs of its
        edge, and what chroma adds to the blur in px; the weights of luma and chromas; the longest step that is
        believed in u, and the noise of a grey value.
    dots : tuple of ndarray
        Which dots count (P, 16); places in px (P, 16, 2) and covariances in u^2 (P, 16, 2, 2), both rewritten.
    """
    image_from_plate, amplitudes, planes, blur_px = plates
    measured, centres_px, covariances_u2 = dots
    tables, limits = known
    plate_from_image, sums, found, most = np.empty((3, 3)), np.empty((ROWS, SUMS)), np.empty(5), PIXELS_FIRST
    pixels, words = np.empty((PIXEL_ROWS, most), dtype=np.float32), np.empty(most, dtype=np.uint32)
    for plate in chosen:
        _reverse(image_from_plate[plate], plate_from_image)
        for dot in np.flatnonzero(measured[plate]):
            place_px = centres_px[plate, dot]
            lie = lie_of(plate_from_image, place_px[0], place_px[1])
            ring_u = _ring(lie, blur_px, limits[0])
            window = window_of(lie, ring_u[1], bgr.shape[1], bgr.shape[0])
            if window[2] > most:
                most = 2 * window[2]
                pixels, words = np.empty((PIXEL_ROWS, most), dtype=np.float32), np.empty(most, dtype=np.uint32)
            count = collect(bgr, lie, window, ring_u, (pixels, words))
            unpack(words, count, pixels[GREY:])
            plate_known = (amplitudes[plate], planes[plate], blur_px, ring_u[1])
            sum_dot(lie, int(dot), plate_known, tables, (pixels, words[:count].view(np.int32), sums))
            _solve_place(sums, limits[1], found)
            _move(lie, found, limits, place_px, covariances_u2[plate, dot])
