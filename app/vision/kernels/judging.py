"""Which fitted plates show what a target must show; of each plate the first test that it fails."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.kernels.inkwell import BLUE, GREEN, RED
from app.vision.kernels.misfits import misfit_of
from app.vision.kernels.ordering import sort_few

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Verdicts = npt.NDArray[np.int64]

# The tests, in the order in which they are made.
STANDS, OUTSIDE_PHOTO, NOT_RED, UNEVEN_RED, BRIGHT_BACKGROUND = 0, 1, 2, 3, 4
NOT_A_PLATE, TOO_FEW_DOTS, WRONG_LAYOUT, RED_DIGIT = 5, 6, 7, 8
BASE_COUNT = len(BASE_CELLS)
LEAST_RED = 1.0  # linear light: what red is divided by
Bounds = tuple[float, ...]


@compiled("float64(float64[:, ::1], boolean[::1], int64)")
def _mean_in_sight(amplitudes: Array, hidden: Mask, channel: int) -> float:
    """Mean of the base dots that nothing covers, in one colour."""
    total, count = 0.0, 0
    for cell in BASE_CELLS:
        if not hidden[cell]:
            total, count = total + amplitudes[cell, channel], count + 1
    return total / max(count, 1)


@compiled("float64(float64[:, ::1], float64[::1], int64, float64[::1])")
def _unevenness(amplitudes: Array, red_level: Array, needed: int, room: Array) -> float:
    """How far the base dots' red is off their plane, but for as many of them as may be covered."""
    for dot in range(BASE_COUNT):
        room[dot] = abs(amplitudes[BASE_CELLS[dot], RED] - red_level[BASE_CELLS[dot]])
    sort_few(room)
    return room[needed - 1]


@compiled("boolean(float64[:, ::1], float64[::1], boolean[::1], UniTuple(float64, 2))")
def _has_red_digit(amplitudes: Array, red_level: Array, inside: Mask, bounds: tuple[float, float]) -> bool:
    """Whether an identification dot is printed in the base dots' red."""
    red_min, off_red_max = bounds
    for cell in DIGIT_CELLS:
        red = amplitudes[cell, RED]
        off_red = max(amplitudes[cell, BLUE], amplitudes[cell, GREEN])
        if inside[cell] and red > red_min * red_level[cell] and off_red < off_red_max * red:
            return True
    return False


@compiled("boolean(float64[:, ::1], UniTuple(float64, 4), UniTuple(float64, 4))")
def _is_bright_behind(planes: Array, seen: Bounds, bounds: Bounds) -> bool:
    """Whether there is no black between the dots.

    ``planes`` is the plate's black by colour; ``seen`` the base dots' mean blue and green, their median red, and what
    the fit explains.
    """
    blue, green, red, explained = seen
    background_max, weakly, always, surely = bounds
    if max(planes[BLUE, 0], planes[GREEN, 0], planes[RED, 0]) > background_max * red:
        return True
    return -min(blue, green) / red > (weakly if explained < surely else always)


@compiled("float64(float64[:, ::1], float64[::1])")
def _median_red(amplitudes: Array, room: Array) -> float:
    for dot in range(BASE_COUNT):
        room[dot] = amplitudes[BASE_CELLS[dot], RED]
    sort_few(room)
    return max(room[BASE_COUNT // 2], LEAST_RED)


@compiled("int64(boolean[::1])")
def _count_base(dots: Mask) -> int:
    """How many of a plate's dots that are marked are base dots."""
    count = 0
    for cell in BASE_CELLS:
        count += dots[cell]
    return count


@compiled("int64(float64[:, ::1], boolean[::1], float64, UniTuple(float64, 2), boolean[::1])")
def _lack_red(amplitudes: Array, red_base: Mask, residual_rms: float, bounds: tuple[float, float], lacks: Mask) -> int:
    """Which base dots do not show red, or no more of it than noise, written; how many do."""
    weak, shown = max(bounds[0], bounds[1] * residual_rms), 0
    for dot in range(BASE_COUNT):
        lacks[dot] = not red_base[dot] or amplitudes[BASE_CELLS[dot], RED] < weak
        shown += not lacks[dot]
    return shown


@compiled(
    "int64(Tuple((float64[:, ::1], float64[:, ::1], float64[::1])), boolean[::1], int64, float64, "
    "UniTuple(float64, 15))"
)
def _judge_colours(
    colours: tuple[Array, Array, Array], hidden: Mask, needed: int, explained: float, bounds: Bounds
) -> int:
    """Whether the base dots are alike, on black, and the whole looks like a plate; ``colours`` as in ``judge_all``."""
    amplitudes, planes, red_level = colours
    uneven_max, background_max, (weakly, always, explained_min, surely) = bounds[2], bounds[5], bounds[6:10]
    room = np.empty(BASE_COUNT)
    mean_red = max(_mean_in_sight(amplitudes, hidden, RED), LEAST_RED)
    if _unevenness(amplitudes, red_level, needed, room) > uneven_max * mean_red:
        return UNEVEN_RED
    blue, green = _mean_in_sight(amplitudes, hidden, BLUE), _mean_in_sight(amplitudes, hidden, GREEN)
    seen = (blue, green, _median_red(amplitudes, room), explained)
    if _is_bright_behind(planes, seen, (background_max, weakly, always, surely)):
        return BRIGHT_BACKGROUND
    return STANDS if explained > explained_min else NOT_A_PLATE


@compiled("int64(boolean[::1], int64, int64, boolean)")
def _judge_dots(measured: Mask, needed: int, dots_min: int, on_grid: bool) -> int:
    """Whether enough dots were measured, and lie on the plate's grid."""
    if measured.sum() < dots_min or _count_base(measured) < needed:
        return TOO_FEW_DOTS
    return STANDS if on_grid else WRONG_LAYOUT


@compiled(
    "void(Tuple((float64[:, :, ::1], float64[:, :, ::1], float64[::1], float64[::1], float64[::1])), "
    "Tuple((float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1], boolean[:, ::1], boolean[:, ::1])), "
    "Tuple((boolean[:, ::1], float64[:, ::1], boolean[:, ::1], boolean[:, ::1])), UniTuple(float64, 15), "
    "Tuple((int64[::1], float64[::1], boolean[:, ::1])))"
)
def judge_all(
    fits: tuple[Array, ...],
    dots: tuple[Array, Array, Array, Mask, Mask],
    inks: tuple[Mask, Array, Mask, Mask],
    bounds: Bounds,
    written: tuple[Verdicts, Array, Mask],
) -> None:
    """Verdicts on P plates.

    Parameters
    ----------
    fits : tuple of ndarray
        Of ``PlateFits`` amplitudes, planes, residual_rms, px_per_u; what they explain.
    dots : tuple of ndarray
        Homographies (P, 3, 3) through the dots; dots in plate coordinates (16, 2); of ``DotCentres`` centres, which
        are measured, which lie inside the photograph.
    inks : tuple of ndarray
        Of ``InkReading`` red_base, red_level, hidden, cut.
    bounds : tuple of float
        The fields of ``JudgementOptions``.
    written : tuple of ndarray
        The test that each plate fails, (P,); how far its dots are off its grid, px, (P,); which base dots lack red,
        (P, 5).
    """
    amplitudes, planes, residual_rms, px_per_u, explained = fits
    refined, plate_u, centres_px, measured, inside = dots
    red_base, red_level, hidden, cut = inks
    verdicts, rms_px, lacks_red = written
    (misfit_max_u, noise_px), base_min, covered_min = bounds[10:12], int(bounds[12]), int(bounds[14])
    for plate in range(len(verdicts)):
        light, level = amplitudes[plate], red_level[plate]
        needed = min(max(BASE_COUNT - _count_base(cut[plate]), covered_min), base_min)
        red_dots = _lack_red(light, red_base[plate], residual_rms[plate], (bounds[0], bounds[1]), lacks_red[plate])
        rms_px[plate] = misfit_of(refined[plate], plate_u, centres_px[plate], measured[plate])
        allowed_px = np.sqrt((misfit_max_u * px_per_u[plate]) ** 2 + noise_px**2)
        if _count_base(inside[plate]) < needed:
            verdicts[plate] = OUTSIDE_PHOTO
        elif red_dots < needed:
            verdicts[plate] = NOT_RED
        else:
            colours = (light, planes[plate], level)
            verdicts[plate] = _judge_colours(colours, hidden[plate], needed, explained[plate], bounds)
        if verdicts[plate] == STANDS:
            verdicts[plate] = _judge_dots(measured[plate], needed, int(bounds[13]), rms_px[plate] < allowed_px)
        if verdicts[plate] == STANDS and _has_red_digit(light, level, inside[plate], (bounds[3], bounds[4])):
            verdicts[plate] = RED_DIGIT
