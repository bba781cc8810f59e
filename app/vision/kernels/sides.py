"""How far along the lines of black between a plate's dots something else is seen, from each side inwards."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import PLATE_SIDE_U
from app.vision.kernels.homographies import image_of
from app.vision.kernels.ordering import sort_few

Array = npt.NDArray[np.float64]
Light = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]
Pixels = npt.NDArray[np.uint8]

SIDES, CHANNELS = 4, 3
HALF_PLATE_U = 0.5 * PLATE_SIDE_U
QUARTER = 4  # the darkest quarter of the gaps is black, also where eight of 21 are covered


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


@compiled("boolean(uint8[:, :, ::1], float32[::1], float64, float64, float64[::1])")
def _light_at(bgr: Pixels, light: Light, x: float, y: float, colour: Array) -> bool:
    """Linear light between pixels, bilinear in grey values, written; whether the place is in the photograph."""
    height, width, _ = bgr.shape
    if not (0.0 <= x <= width - 1.0 and 0.0 <= y <= height - 1.0):
        return False
    left, top = int(x), int(y)
    right, bottom = min(left + 1, width - 1), min(top + 1, height - 1)
    along, down = x - left, y - top
    for channel in range(CHANNELS):
        above = bgr[top, left, channel] * (1.0 - along) + bgr[top, right, channel] * along
        below = bgr[bottom, left, channel] * (1.0 - along) + bgr[bottom, right, channel] * along
        colour[channel] = light[int(above * (1.0 - down) + below * down + 0.5)]
    return True


@compiled("void(uint8[:, :, ::1], float32[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1])")
def _find_black(bgr: Pixels, light: Light, image_from_plate: Array, gaps_u: Array, room: Array, black: Array) -> None:
    """The plate's black, written: of each colour the darkest quarter of the gaps between the dots."""
    colour, seen = np.empty(CHANNELS), 0
    for gap in range(len(gaps_u)):
        x, y = image_of(image_from_plate, gaps_u[gap, 0], gaps_u[gap, 1])
        if _light_at(bgr, light, x, y, colour):
            for channel in range(CHANNELS):
                room[channel, seen] = colour[channel]
            seen += 1
    for channel in range(CHANNELS):
        sort_few(room[channel, :seen])
        black[channel] = room[channel, seen // QUARTER] if seen else 0.0


@compiled("boolean(uint8[:, :, ::1], float32[::1], float64[:, ::1], UniTuple(float64, 2), float64[:, ::1], float64)")
def _is_foreign(
    bgr: Pixels, light: Light, image_from_plate: Array, at_u: tuple[float, float], colours: Array, limit: float
) -> bool:
    """Whether a plate point is another colour than black, the first of ``colours``, or outside the photograph."""
    black, here = colours[0], colours[1]
    x, y = image_of(image_from_plate, at_u[0], at_u[1])
    if not _light_at(bgr, light, x, y, here):
        return True
    off = 0.0
    for channel in range(CHANNELS):
        off = max(off, abs(here[channel] - black[channel]))
    return off > limit


@compiled(
    "float64(uint8[:, :, ::1], float32[::1], float64[:, ::1], Tuple((float64[::1], float64[::1], int64[:, ::1])), "
    "float64[:, ::1], UniTuple(float64, 2))"
)
def _black_in_sight(
    bgr: Pixels,
    light: Light,
    image_from_plate: Array,
    walked: tuple[Array, Array, Indices],
    colours: Array,
    limits: tuple[float, float],
) -> float:
    """Part of the lines that is black, behind whatever covers the sides; 0 where too little of the plate is left."""
    lines_u, inwards_u, leading = walked
    clear_u = np.zeros(SIDES)
    for side in range(SIDES):
        for line in range(len(lines_u)):
            if leading[side, line] > 0:
                clear_u[side] = max(clear_u[side], inwards_u[min(leading[side, line], len(inwards_u) - 1)])
    limit, area_min = limits
    wide, high = 1.0 - (clear_u[1] + clear_u[3]) / PLATE_SIDE_U, 1.0 - (clear_u[0] + clear_u[2]) / PLATE_SIDE_U
    if min(wide, high) <= 0.0 or wide * high < area_min:
        return 0.0
    dark, count = 0, 0
    for side in range(SIDES):
        opposite, first, last = (side + 2) % SIDES, (side + 3) % SIDES, (side + 1) % SIDES
        for line_u in lines_u:
            for deep_u in inwards_u:
                if deep_u <= clear_u[side] or PLATE_SIDE_U - deep_u <= clear_u[opposite]:
                    continue
                if HALF_PLATE_U + line_u <= clear_u[first] or HALF_PLATE_U - line_u <= clear_u[last]:
                    continue
                count += 1
                dark += not _is_foreign(bgr, light, image_from_plate, from_side(side, line_u, deep_u), colours, limit)
    return dark / max(count, 1)


@compiled(
    "void(uint8[:, :, ::1], Tuple((float32[::1], float64[:, ::1], float64[::1], float64[::1])), float64[:, :, ::1], "
    "float64[::1], Tuple((int64, float64)), int64[:, :, ::1], float64[::1])"
)
def walk_lines(
    bgr: Pixels,
    tables: tuple[Light, Array, Array, Array],
    image_from_plate: Array,
    limits: Array,
    bounds: tuple[int, float],
    leading: Indices,
    black_share: Array,
) -> None:
    """Steps of each line, from each side, that are not black, and the part of the rest that is.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    tables : tuple of ndarray
        Linear light of grey values (256,); black plate points (G, 2); lines (5,) and steps inwards (D,), u.
    image_from_plate : ndarray of shape (P, 3, 3)
    limits : ndarray of shape (P,)
        How far a colour may be off black, linear light.
    bounds : tuple
        Lines that must begin with two foreign steps, or their side counts as clear; part of the plate's area that must
        be left.
    leading : ndarray of shape (P, 4, 5), written
        0 of plates on which a side's lines never become black.
    black_share : ndarray of shape (P,), written
        Only of plates that are covered from some side, and in part; 0 of others.
    """
    light, gaps_u, lines_u, inwards_u = tables
    colours, room = np.empty((2, CHANNELS)), np.empty((CHANNELS, len(gaps_u)))
    leading[:] = 0
    black_share[:] = 0.0
    for plate in range(len(image_from_plate)):
        image, limit, covered = image_from_plate[plate], limits[plate], False
        _find_black(bgr, light, image, gaps_u, room, colours[0])
        for side in range(SIDES):
            lines, through = 0, 0
            for line in range(len(lines_u)):
                steps = 0
                for deep_u in inwards_u:
                    if not _is_foreign(bgr, light, image, from_side(side, lines_u[line], deep_u), colours, limit):
                        break
                    steps += 1
                leading[plate, side, line] = steps
                lines += steps > 1
                through += steps == len(inwards_u)
            if lines < bounds[0]:
                leading[plate, side] = 0
            covered = covered or lines >= bounds[0]
            if through >= bounds[0]:  # too little is left, or this is no plate
                leading[plate], covered = 0, False
                break
        if covered:
            walked = (lines_u, inwards_u, leading[plate])
            black_share[plate] = _black_in_sight(bgr, light, image, walked, colours, (limit, bounds[1]))
