"""How far along the lines of black between a plate's dots something else is seen, from each side inwards.

A plate is left at the first thing that tells against it: most that are looked at are in plain view, or no plates.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import PLATE_SIDE_U
from app.vision.kernels.homographies import image_of
from app.vision.kernels.light import CHANNELS, PHOTO, Light, Photo, Pixels, corner_at, is_inside, light_at

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

SIDES = 4
ANY_SIDE = -1
HALF_PLATE_U = 0.5 * PLATE_SIDE_U
QUARTER = 4  # the darkest quarter of the gaps is black, also where eight of 21 are covered

# A photograph, a plate in it, the plate's black, and how far a colour may be off that.
VIEW = f"Tuple(({PHOTO}, float64[:, ::1], float64[::1], float64))"
View = tuple[Photo, Array, Array, float]
LINES = "Tuple((float64[::1], float64[::1]))"  # where they are, and the steps inwards, u
Lines = tuple[Array, Array]


@compiled("UniTuple(float64, 2)(int64, float64, float64)")
def from_side(side: int, across_u: float, inwards_u: float) -> tuple[float, float]:
    """Plate coordinates of a point that lies so far inwards from the top, right, bottom or left side."""
    down = inwards_u - HALF_PLATE_U
    if side == 0:
        return across_u, down
    if side == 1:
        return -down, across_u
    if side == 2:
        return -across_u, -down
    return down, -across_u


@compiled("void(float64, int64, float64[::1])")
def _keep_least(value: float, count: int, least: Array) -> None:
    """Put a value in its place among the least of ``count`` before it."""
    slot = min(count, len(least) - 1)
    if count >= len(least) and value >= least[slot]:
        return
    while slot > 0 and least[slot - 1] > value:
        least[slot] = least[slot - 1]
        slot -= 1
    least[slot] = value


@compiled(f"void({PHOTO}, float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1])")
def _find_black(photo: Photo, image_from_plate: Array, gaps_u: Array, least: Array, black: Array) -> None:
    """The plate's black, written: of each colour the darkest quarter of the gaps between the dots."""
    seen = 0
    for gap in range(len(gaps_u)):
        x, y = image_of(image_from_plate, gaps_u[gap, 0], gaps_u[gap, 1])
        if is_inside(photo, x, y):
            corner = corner_at(photo, x, y)
            for channel in range(CHANNELS):
                _keep_least(light_at(photo, corner, channel), seen, least[channel])
            seen += 1
    for channel in range(CHANNELS):
        black[channel] = least[channel, seen // QUARTER] if seen else 0.0


@compiled(f"boolean({VIEW}, int64, float64, float64)")
def _is_foreign(view: View, side: int, line_u: float, deep_u: float) -> bool:
    """Whether a plate point is another colour than black, or outside the photograph."""
    photo, image_from_plate, black, limit = view
    x_u, y_u = from_side(side, line_u, deep_u)
    x, y = image_of(image_from_plate, x_u, y_u)
    if not is_inside(photo, x, y):
        return True
    corner, off = corner_at(photo, x, y), 0.0
    for channel in range(CHANNELS):
        off = max(off, abs(light_at(photo, corner, channel) - black[channel]))
    return off > limit


@compiled(f"int64({VIEW}, int64, float64, float64[::1])")
def _steps_to_black(view: View, side: int, line_u: float, inwards_u: Array) -> int:
    """Steps inwards along a line before the plate's black begins."""
    for step in range(len(inwards_u)):
        if not _is_foreign(view, side, line_u, inwards_u[step]):
            return step
    return len(inwards_u)


@compiled(f"boolean({VIEW}, {LINES}, int64, int64, int64[:, ::1])")
def _walk_sides(view: View, lines: Lines, lines_min: int, must: int, leading: Indices) -> bool:
    """Steps on each line, written, before black begins; whether a side is covered, and the one that must be."""
    lines_u, inwards_u = lines
    covered = False
    leading[:] = 0
    for turn in range(SIDES):
        side = (max(must, 0) + turn) % SIDES
        ended, through = 0, 0
        for line in range(len(lines_u)):
            if ended + len(lines_u) - line < lines_min:
                break  # too few can end
            steps = _steps_to_black(view, side, lines_u[line], inwards_u)
            leading[side, line] = steps
            ended += steps > 1
            through += steps == len(inwards_u)
            if through >= lines_min:  # too little is left, or this is no plate
                return False
        if ended >= lines_min:
            covered = True
        elif side == must:
            return False
        else:
            leading[side] = 0
    return covered


@compiled("boolean(float64[::1], int64, float64)")
def _is_step_clear(clear_u: Array, side: int, deep_u: float) -> bool:
    """Whether what lies so far in from a side lies behind whatever covers it and the opposite one."""
    return bool(deep_u > clear_u[side] and PLATE_SIDE_U - deep_u > clear_u[(side + 2) % SIDES])


@compiled("boolean(float64[::1], int64, float64)")
def _is_line_clear(clear_u: Array, side: int, line_u: float) -> bool:
    """Whether a line from a side lies behind whatever covers the two beside it."""
    first, last = clear_u[(side + 3) % SIDES], clear_u[(side + 1) % SIDES]
    return bool(HALF_PLATE_U + line_u > first and HALF_PLATE_U - line_u > last)


@compiled(f"int64(float64[::1], {LINES})")
def _count_clear(clear_u: Array, lines: Lines) -> int:
    """How many points of the lines lie behind whatever covers the sides."""
    count = 0
    for side in range(SIDES):
        on_lines, inwards = 0, 0
        for line_u in lines[0]:
            on_lines += _is_line_clear(clear_u, side, line_u)
        for deep_u in lines[1]:
            inwards += _is_step_clear(clear_u, side, deep_u)
        count += on_lines * inwards
    return count


@compiled(f"boolean({VIEW}, {LINES}, float64[::1], float64)")
def _is_black_behind(view: View, lines: Lines, clear_u: Array, share_min: float) -> bool:
    """Whether the lines are black behind whatever covers the sides."""
    lines_u, inwards_u = lines
    count = _count_clear(clear_u, lines)
    dark = count
    for side in range(SIDES):
        for line_u in lines_u:
            if not _is_line_clear(clear_u, side, line_u):
                continue
            for deep_u in inwards_u:
                if _is_step_clear(clear_u, side, deep_u) and _is_foreign(view, side, line_u, deep_u):
                    dark -= 1
                    if not dark / count > share_min:
                        return False
    return count > 0


@compiled("boolean(int64[:, ::1], float64[::1], float64, float64[::1])")
def _is_enough_left(leading: Indices, inwards_u: Array, area_min: float, clear_u: Array) -> bool:
    """Whether so much of a plate's area is in sight; how far in all lines of a side are clear, written."""
    for side in range(SIDES):
        deepest = leading[side].max()
        clear_u[side] = inwards_u[min(deepest, len(inwards_u) - 1)] if deepest > 0 else 0.0
    wide, high = 1.0 - (clear_u[1] + clear_u[3]) / PLATE_SIDE_U, 1.0 - (clear_u[0] + clear_u[2]) / PLATE_SIDE_U
    return bool(min(wide, high) > 0.0 and wide * high >= area_min)


@compiled(
    "void(uint8[:, :, ::1], Tuple((float32[::1], float64[:, ::1], float64[::1], float64[::1])), float64[:, :, ::1], "
    "float64[::1], int64[::1], Tuple((int64, float64, float64, float64)), float64[:, :, ::1])"
)
def walk_lines(
    bgr: Pixels,
    tables: tuple[Light, Array, Array, Array],
    image_from_plate: Array,
    limits: Array,
    must: Indices,
    bounds: tuple[int, float, float, float],
    depths_u: Array,
) -> None:
    """How far sides are covered on each line of plates of which the rest looks like a plate.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    tables : tuple of ndarray
        Linear light of grey values (256,); black plate points (G, 2); lines (5,) and steps inwards (D,), u.
    image_from_plate : ndarray of shape (P, 3, 3)
    limits : ndarray of shape (P,)
        How far a colour may be off black, linear light.
    must : ndarray of shape (P,)
        The side that must be covered, or ``ANY_SIDE``.
    bounds : tuple
        Lines that must begin with two foreign steps, or their side counts as clear; part of the plate's area that must
        be left; part of its lines that must be black there; what is added to a depth, u.
    depths_u : ndarray of shape (P, 4, 5), written
        0 of plates that nothing covers, and of those that do not look like plates beside it.
    """
    light, gaps_u, lines_u, inwards_u = tables
    black, least = np.empty(CHANNELS), np.empty((CHANNELS, len(gaps_u) // QUARTER + 1))
    photo = (bgr.reshape(-1), bgr.shape[0], bgr.shape[1], light)
    leading, clear_u = np.empty((SIDES, len(lines_u)), dtype=np.int64), np.empty(SIDES)
    lines, (lines_min, area_min, black_share_min, margin_u) = (lines_u, inwards_u), bounds
    depths_u[:] = 0.0
    for plate in range(len(image_from_plate)):
        _find_black(photo, image_from_plate[plate], gaps_u, least, black)
        view = (photo, image_from_plate[plate], black, limits[plate])
        if not _walk_sides(view, lines, lines_min, must[plate], leading):
            continue
        enough = _is_enough_left(leading, inwards_u, area_min, clear_u)
        if enough and _is_black_behind(view, lines, clear_u, black_share_min):
            for side in range(SIDES):
                for line in range(len(lines_u)):
                    if leading[side, line] > 0:
                        depths_u[plate, side, line] = inwards_u[leading[side, line] - 1] + margin_u
