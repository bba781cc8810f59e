"""Where dots stand, from every pixel about their edges: one step of least squares on the grey values themselves.

Each dot has its two coordinates, and in luma and in both chromas an amplitude and a background beside them. What its
neighbours and the paper throw into its pixels is known from the plate's fit.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import CELLS_PER_SIDE, DOT_COUNT, DOT_PITCH_U, PLATE_SIDE_U
from app.vision.kernels.homographies import image_of, px_by_u_at
from app.vision.kernels.profiles import EDGE_REACH, edge_profile, grey_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Pixels = npt.NDArray[np.uint8]

ROWS = 3  # luma and two chromas
# Of products, with x, y for the derivatives by the place, s for the share, r for what is missing, and 1:
SUMS = 14  # xx, xy, yy, xs, ys, ss, x, y, s, 1, rx, ry, rs, r
# Rows of a dot's pixels: share of the dot's light and its change along x and y, other light, grey values; then factor
# of the profile and what is missing, for luma and both chromas.
SHARE, BY_X, BY_Y, LIGHT, GREY, FACTORS = 0, 1, 2, 3, 6, 9
STRAY_BLURS = 4.0  # farther from an edge than this less than 1e-4 of its light strays
SINGULAR = 1e-6  # of a product of diagonals: a window that shows no background besides the dot
AMPLITUDE_MIN, AMPLITUDE_MAX = 0.3, 3.0  # of the plate's fit: beyond, that has seen another dot
STRAIGHT_BLUR_U = 0.001  # a dot of hardly any blur has an edge as straight as paper
NUMBERS = "UniTuple(float64, 4)"
PLATE = "Tuple((float64[:, ::1], float64[:, ::1], float64))"
TABLES = "Tuple((float64[:, ::1], float64[::1], float64[:, ::1], float64[:, ::1]))"


@compiled(f"float64(float64, float64, {NUMBERS}, float64)")
def _blur_towards(along: float, down: float, u_by_px: tuple[float, ...], blur_px: float) -> float:
    """Standard deviation, in u, of a blur that is round in the picture, along a direction of unit length."""
    by_x = along * u_by_px[0] + down * u_by_px[2]
    by_y = along * u_by_px[1] + down * u_by_px[3]
    return blur_px * np.sqrt(by_x * by_x + by_y * by_y)


@compiled(f"void({NUMBERS}, int64, {NUMBERS}, {PLATE}, Tuple((float64[:, ::1], float64[::1])))")
def _light_around(
    place: tuple[float, ...],
    dot: int,
    u_by_px: tuple[float, ...],
    plate: tuple[Array, Array, float],
    written: tuple[Array, Array],
) -> None:
    """Light of the black, of the two nearest neighbours and of the paper at a pixel; ``place`` is x, y and from dot."""
    amplitudes, planes, blur_px = plate
    edges, light = written
    x, y, along, down = place
    for channel in range(3):
        light[channel] = planes[channel, 0] + planes[channel, 1] * x + planes[channel, 2] * y
    row, column = dot // CELLS_PER_SIDE, dot % CELLS_PER_SIDE
    for axis in range(2):
        reach_u = EDGE_REACH * _blur_towards(0.0 if axis else 1.0, 1.0 if axis else 0.0, u_by_px, blur_px)
        towards = 1.0 if (down if axis else along) > 0.0 else -1.0
        next_row = row + (int(towards) if axis else 0)
        next_column = column + (0 if axis else int(towards))
        if 0 <= next_row < CELLS_PER_SIDE and 0 <= next_column < CELLS_PER_SIDE:
            if abs(down if axis else along) < DOT_PITCH_U - 1.0 - reach_u:
                continue
            off_x = along - (0.0 if axis else towards * DOT_PITCH_U)
            off_y = down - (towards * DOT_PITCH_U if axis else 0.0)
            away = np.sqrt(off_x * off_x + off_y * off_y)
            blur_u = _blur_towards(off_x / away, off_y / away, u_by_px, blur_px)
            share, _ = edge_profile(edges, away, blur_u)
            neighbour = CELLS_PER_SIDE * next_row + next_column
            for channel in range(3):
                light[channel] += share * amplitudes[neighbour, channel]
        else:
            inwards = EDGE_REACH * (PLATE_SIDE_U / 2.0 - abs(y if axis else x)) / reach_u
            share, _ = edge_profile(edges, 1.0 + inwards * STRAIGHT_BLUR_U, STRAIGHT_BLUR_U)
            for channel in range(3):
                paper = planes[channel, 3] + planes[channel, 4] * x + planes[channel, 5] * y
                light[channel] += share * paper


@compiled("void(float64[:, ::1], int64, float64[::1], Tuple((float64[::1], float64[:, ::1])), float64[:, ::1])")
def _sum_up(pixels: Array, count: int, amplitude: Array, tables: tuple[Array, Array], sums: Array) -> None:
    """Sums of products over the first pixels of ``pixels`` (15, N), whose last six rows are written on the way.

    In a row all derivatives but the background's are the profile's (share, and its change as the dot moves along x and
    y) by one factor.
    """
    greys, ycc_from_bgr = tables
    share, by_x, by_y = pixels[SHARE], pixels[BY_X], pixels[BY_Y]
    for pixel in range(count):
        for row in range(FACTORS, FACTORS + 2 * ROWS):
            pixels[row, pixel] = 0.0
        for channel in range(3):
            light = pixels[LIGHT + channel, pixel] + amplitude[channel] * share[pixel]
            shown, slope = grey_of(greys, light)
            missing, slope = pixels[GREY + channel, pixel] - shown, slope * amplitude[channel]
            for line in range(ROWS):
                pixels[FACTORS + 2 * line, pixel] += ycc_from_bgr[line, channel] * slope
                pixels[FACTORS + 2 * line + 1, pixel] += ycc_from_bgr[line, channel] * missing
    for line in range(ROWS):
        factors, offs = pixels[FACTORS + 2 * line], pixels[FACTORS + 2 * line + 1]
        xx, xy, yy, xs, ys, ss, x, y, s, rx, ry, rs, r = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for pixel in range(count):
            along, down, full, off = (
                factors[pixel] * by_x[pixel],
                factors[pixel] * by_y[pixel],
                factors[pixel] * share[pixel],
                offs[pixel],
            )
            xx, xy, yy = xx + along * along, xy + along * down, yy + down * down
            xs, ys, ss = xs + along * full, ys + down * full, ss + full * full
            x, y, s = x + along, y + down, s + full
            rx, ry, rs, r = rx + off * along, ry + off * down, rs + off * full, r + off
        sums[line, 0], sums[line, 1], sums[line, 2], sums[line, 3], sums[line, 4] = xx, xy, yy, xs, ys
        sums[line, 5], sums[line, 6], sums[line, 7], sums[line, 8], sums[line, 9] = ss, x, y, s, float(count)
        sums[line, 10], sums[line, 11], sums[line, 12], sums[line, 13] = rx, ry, rs, r


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


@compiled(f"void(uint8[:, :, ::1], UniTuple(float64, 3), float64[:, ::1], {PLATE}, {TABLES}, float64[::1])")
def settle_dot(
    bgr: Pixels,
    seen: tuple[float, float, float],
    plate_from_image: Array,
    plate: tuple[Array, Array, float],
    tables: tuple[Array, Array, Array, Array],
    written: Array,
) -> None:
    """One dot's step; ``seen`` are its pixel and its number, ``written`` x, y, and the information xx, xy, yy."""
    amplitudes, planes, blur_px = plate
    edges, greys, ycc_from_bgr, limits = tables
    centre_x, centre_y, dot = seen[0], seen[1], int(seen[2])
    middle_x, middle_y = image_of(plate_from_image, centre_x, centre_y)
    u_by_px = px_by_u_at(plate_from_image, centre_x, centre_y)
    area = abs(u_by_px[0] * u_by_px[3] - u_by_px[1] * u_by_px[2])
    reach_u, width = limits[0, 0], limits[0, 1] * np.hypot(1.0, limits[0, 2] / blur_px)
    reach_x = reach_u * np.sqrt(u_by_px[3] ** 2 + u_by_px[1] ** 2) / area
    reach_y = reach_u * np.sqrt(u_by_px[2] ** 2 + u_by_px[0] ** 2) / area
    left, right = max(int(np.ceil(centre_x - reach_x)), 0), min(int(centre_x + reach_x), bgr.shape[1] - 1)
    top, bottom = max(int(np.ceil(centre_y - reach_y)), 0), min(int(centre_y + reach_y), bgr.shape[0] - 1)
    # Where neither a neighbour nor the paper reaches, both of which end as far from the dot's middle, there is black.
    most_px = np.sqrt(u_by_px[0] ** 2 + u_by_px[1] ** 2 + u_by_px[2] ** 2 + u_by_px[3] ** 2)
    clear_u = DOT_PITCH_U - 1.0 - STRAY_BLURS * blur_px * most_px
    sums, light, count = np.empty((ROWS, SUMS)), np.empty(3), 0
    pixels = np.empty((FACTORS + 2 * ROWS, max((right - left + 1) * (bottom - top + 1), 0)))
    h, most_u = plate_from_image, width * blur_px * most_px
    nearest_u, farthest_u = max(1.0 - most_u, 0.0), min(1.0 + most_u, reach_u)
    for row in range(top, bottom + 1):
        x_by_row, y_by_row = h[0, 1] * row + h[0, 2], h[1, 1] * row + h[1, 2]
        depth_by_row = h[2, 1] * row + h[2, 2]
        for column in range(left, right + 1):
            depth = 1.0 / (h[2, 0] * column + depth_by_row)
            x, y = (h[0, 0] * column + x_by_row) * depth, (h[1, 0] * column + y_by_row) * depth
            along, down = x - middle_x, y - middle_y
            away2 = along * along + down * down
            if away2 > farthest_u * farthest_u or away2 < nearest_u * nearest_u:
                continue
            away = max(np.sqrt(away2), 1e-9)
            towards_x = (along * u_by_px[0] + down * u_by_px[2]) / away
            towards_y = (along * u_by_px[1] + down * u_by_px[3]) / away
            blur_u = blur_px * np.sqrt(towards_x * towards_x + towards_y * towards_y)
            if abs(away - 1.0) > width * blur_u:
                continue
            share, by_away = edge_profile(edges, away, blur_u)
            # A dot that moves towards a pixel shortens its distance from it.
            by_x, by_y = -by_away * towards_x, -by_away * towards_y
            if abs(along) > clear_u or abs(down) > clear_u:
                _light_around((x, y, along, down), dot, u_by_px, plate, (edges, light))
                for channel in range(3):
                    pixels[LIGHT + channel, count] = light[channel]
            else:
                for channel in range(3):
                    black = planes[channel, 0] + planes[channel, 1] * x + planes[channel, 2] * y
                    pixels[LIGHT + channel, count] = black
            for channel in range(3):
                pixels[GREY + channel, count] = bgr[row, column, channel]
            pixels[SHARE, count], pixels[BY_X, count], pixels[BY_Y, count] = share, by_x, by_y
            count += 1
    _sum_up(pixels, count, amplitudes[dot], (greys, ycc_from_bgr), sums)
    _solve_place(sums, limits[1], written)


@compiled(
    "void(uint8[:, :, ::1], Tuple((float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64)), "
    f"Tuple((float64[:, :, ::1], boolean[:, ::1])), {TABLES}, float64[:, :, ::1])"
)
def settle_all(
    bgr: Pixels,
    plates: tuple[Array, Array, Array, float],
    dots: tuple[Array, Mask],
    tables: tuple[Array, Array, Array, Array],
    written: Array,
) -> None:
    """Steps of all measured dots of P plates.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    plates : tuple
        Homographies from pixels to plate coordinates (P, 3, 3); the dots' light (P, 16, 3); the planes of black and
        paper, constant and per u (P, 3, 6); the blur's standard deviation in px.
    dots : tuple of ndarray
        Places in px (P, 16, 2), and which dots count (P, 16).
    tables : tuple of ndarray
        Edge profiles; grey values of light; luma and chromas of blue, green, red (3, 3); and, shape (2, 3), how far
        about a dot pixels count in u and in blurs of its edge, and the weights of luma and chromas.
    written : ndarray of shape (P, 16, 5)
        Offset x, y in px, and its information xx, xy, yy for a noise of one grey value.
    """
    plate_from_image, amplitudes, planes, blur_px = plates
    centres_px, measured = dots
    for plate in range(len(plate_from_image)):
        known = (amplitudes[plate], planes[plate], blur_px)
        for dot in range(DOT_COUNT):
            written[plate, dot] = 0.0
            if measured[plate, dot]:
                seen = (centres_px[plate, dot, 0], centres_px[plate, dot, 1], float(dot))
                settle_dot(bgr, seen, plate_from_image[plate], known, tables, written[plate, dot])
