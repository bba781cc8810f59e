"""Which ink each dot of a plate shows, against the plate's own red."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import BASE_CELLS, CELLS_PER_SIDE, DIGIT_CELLS
from app.vision.kernels.ordering import middle_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Digits = npt.NDArray[np.int8]

BLUE, GREEN, RED = 0, 1, 2
BLACK_DIGIT, GREEN_DIGIT, WHITE_DIGIT, HIDDEN_DIGIT = 0, 1, 2, -1
BASE_COUNT = len(BASE_CELLS)


@compiled("float64(float64[:, ::1], UniTuple(float64, 12), boolean[::1], float64[::1])")
def _read_base(amplitudes: Array, bounds: tuple[float, ...], red_base: Mask, base_red: Array) -> float:
    """Which base dots are red, and the red at each, that of the plate where something covers it; returns the median."""
    base_red_min, off_red_max = bounds[0], bounds[1]
    for dot in range(BASE_COUNT):
        base_red[dot] = amplitudes[BASE_CELLS[dot], RED]
    middle = middle_of(base_red)
    for dot in range(BASE_COUNT):
        cell = BASE_CELLS[dot]
        base_red[dot] = amplitudes[cell, RED]  # they were put in order
        off_red = max(amplitudes[cell, BLUE], amplitudes[cell, GREEN])
        pure = off_red <= off_red_max * max(base_red[dot], 1.0)
        red_base[dot] = pure and base_red[dot] > base_red_min * middle
        if not red_base[dot]:
            base_red[dot] = middle
    return middle


@compiled("void(float64[::1], float64[:, ::1], float64[::1])")
def _spread_red(base_red: Array, level_from_base: Array, red_level: Array) -> None:
    """Red expected at each dot: a plane through the base dots, kept within their range, at least one grey value."""
    least, most = base_red.min(), base_red.max()
    for dot in range(len(red_level)):
        level = 0.0
        for base in range(BASE_COUNT):
            level += level_from_base[dot, base] * base_red[base]
        red_level[dot] = max(min(max(level, least), most), 1.0)


@compiled("int64(float64, float64, UniTuple(float64, 12))")
def _digit_of(red: float, green: float, bounds: tuple[float, ...]) -> int:
    """The digit of a dot's red and green in units of the plate's red."""
    _, _, white_red, green_green, white_green_min, white_max, dark_min, _, _, _, _, _ = bounds
    if max(red, green) > white_max or min(red, green) < dark_min:
        return HIDDEN_DIGIT
    if red > white_red:
        return WHITE_DIGIT if green >= white_green_min else HIDDEN_DIGIT
    return GREEN_DIGIT if green > green_green else BLACK_DIGIT


@compiled("UniTuple(float64, 2)(float64[::1], boolean[::1])")
def _least_and_most(base_red: Array, red_base: Mask) -> tuple[float, float]:
    """Least and greatest red of the base dots that are seen; at least one grey value."""
    least, most = np.inf, 1.0
    for dot in range(BASE_COUNT):
        if red_base[dot]:
            least, most = min(least, base_red[dot]), max(most, base_red[dot])
    return max(min(least, most), 1.0), most


@compiled("float64(float64[:, ::1], int64, int64, float64)")
def _light_about(amplitudes: Array, cell: int, channel: int, aslant: float) -> float:
    """Light of the dots beside a cell, and a part of that of those aslant."""
    row, column, light = cell // CELLS_PER_SIDE, cell % CELLS_PER_SIDE, 0.0
    for other in range(len(amplitudes)):
        down, along = abs(other // CELLS_PER_SIDE - row), abs(other % CELLS_PER_SIDE - column)
        if max(down, along) == 1:
            light += amplitudes[other, channel] * (aslant if down == along else 1.0)
    return light


@compiled("float64(float64[:, ::1], boolean[::1], UniTuple(float64, 12))")
def _stray_share(amplitudes: Array, red_base: Mask, bounds: tuple[float, ...]) -> float:
    """Part of its neighbours' light that a dot is given, as the green of the base dots tells, which have none."""
    base_green, aslant = bounds[9], bounds[10]
    together, alone = 0.0, 0.0
    for dot in range(BASE_COUNT):
        if red_base[dot]:
            cell = BASE_CELLS[dot]
            about = _light_about(amplitudes, cell, GREEN, aslant)
            together += (amplitudes[cell, GREEN] - base_green * amplitudes[cell, RED]) * about
            alone += about * about
    return max(together / max(alone, 1e-9), 0.0)


@compiled("Tuple((int64, float64))(UniTuple(float64, 2), UniTuple(float64, 2), float64, UniTuple(float64, 12))")
def _digit_in_shadow(
    dot: tuple[float, float], stray: tuple[float, float], least: float, bounds: tuple[float, ...]
) -> tuple[int, float]:
    """The digit of a dot on a plate that lies partly in shadow, and its confidence.

    Where the shadow ends between the base dots is not known: any dot may have the least light or the most. Black parts
    from green where the light is least, and what is brighter is told by its colour instead of its brightness. There a
    few per cent of a lit neighbour are as much as a colour in the shadow: they are taken off, and doubted.

    Parameters
    ----------
    dot, stray : tuple of float
        Red and green of the dot, and what of them comes from its neighbours.
    least : float
        Red of the base dot that has the least light.
    """
    green_green, white_over_green, unsure = bounds[3], bounds[8], bounds[11] * max(stray[0], stray[1])
    red, green = dot[0] - stray[0], dot[1] - stray[1]
    lit = max(red, green) / least
    from_black = (abs(lit - green_green) - unsure / least) / green_green
    if lit <= green_green:
        return BLACK_DIGIT, from_black
    from_other = (abs(red - white_over_green * green) - unsure) / max(white_over_green * green, 1e-9)
    if red > white_over_green * green:
        return (WHITE_DIGIT if green > white_over_green * red else HIDDEN_DIGIT), min(from_black, from_other)
    return GREEN_DIGIT, min(from_black, from_other)


@compiled("Tuple((int64, float64))(float64[:, ::1], int64, UniTuple(float64, 2), UniTuple(float64, 12))")
def _read_in_shadow(
    amplitudes: Array, cell: int, light: tuple[float, float], bounds: tuple[float, ...]
) -> tuple[int, float]:
    """As ``_digit_in_shadow``, of a plate's cell; ``light`` is the least on the plate, and the part that strays."""
    least, share = light
    aslant = bounds[10]
    stray_red = share * _light_about(amplitudes, cell, RED, aslant)
    stray_green = share * _light_about(amplitudes, cell, GREEN, aslant)
    dot = (amplitudes[cell, RED], amplitudes[cell, GREEN])
    return _digit_in_shadow(dot, (stray_red, stray_green), least, bounds)


@compiled(
    "void(float64[:, :, ::1], float64[:, ::1], UniTuple(float64, 12), Tuple((boolean[:, ::1], int8[:, ::1], "
    "float64[:, ::1], float64[:, ::1])))"
)
def read_plates_inks(
    amplitudes: Array, level_from_base: Array, bounds: tuple[float, ...], reading: tuple[Mask, Digits, Array, Array]
) -> None:
    """Read plates whose dots have amplitudes of shape (P, 16, 3): blue, green, red.

    Parameters
    ----------
    amplitudes : ndarray of shape (P, 16, 3)
    level_from_base : ndarray of shape (16, 5)
        Takes the red of the base dots to that of all dots.
    bounds : tuple of float
        The fields of ``InkOptions``, in their order: base_red_min, base_off_red_max, white_red, green_green,
        white_green_min, white_max, dark_min, even_min, white_over_green, base_green, stray_aslant, stray_unsure.
    reading : tuple of ndarray, written
        Which base dots are red (P, 5), digits (P, 11), their confidence (P, 11), red expected at each dot (P, 16).
    """
    red_base, digits, confidence, red_level = reading
    white_red, green_green, even_min = bounds[2], bounds[3], bounds[7]
    base_red = np.empty(BASE_COUNT)
    for plate in range(len(amplitudes)):
        _read_base(amplitudes[plate], bounds, red_base[plate], base_red)
        _spread_red(base_red, level_from_base, red_level[plate])
        least, most = _least_and_most(base_red, red_base[plate])
        share = _stray_share(amplitudes[plate], red_base[plate], bounds) if least < even_min * most else 0.0
        for place in range(len(DIGIT_CELLS)):
            cell = DIGIT_CELLS[place]
            red = amplitudes[plate, cell, RED] / red_level[plate, cell]
            green = amplitudes[plate, cell, GREEN] / red_level[plate, cell]
            digits[plate, place] = _digit_of(red, green, bounds)
            if least < even_min * most and digits[plate, place] != HIDDEN_DIGIT:
                digits[plate, place], confidence[plate, place] = _read_in_shadow(
                    amplitudes[plate], cell, (least, share), bounds
                )
                continue
            from_red = abs(red - white_red) / white_red
            from_green = abs(green - green_green) / green_green
            confidence[plate, place] = from_red if red > white_red else min(from_red, from_green)
