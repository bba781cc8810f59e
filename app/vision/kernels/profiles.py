"""What a pixel should show: the blurred edge of a dot, and the grey value of light, from tables."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]

EDGE_REACH = 6.0  # standard deviations of the blur on either side of a dot's edge: beyond is nothing to see
EDGE_STEPS = 20  # per standard deviation
BLUR_STEP_U = 0.03
BLUR_LEVELS = 50  # up to 1.5 u: a picture of 1 px per u, or seen at a grazing angle
LIGHT_MAX = 255.0
LIGHT_STEPS = 32  # per unit of light: where the curve of grey values is steepest, a step is half of one


@compiled("UniTuple(float64, 2)(float64[:, ::1], float64, float64)")
def edge_profile(table: Array, radius_u: float, blur_u: float) -> tuple[float, float]:
    """Share of a unit disc's light at a distance from its centre, and its derivative by that distance.

    Parameters
    ----------
    table : ndarray of shape (BLUR_LEVELS + 1, 2 EDGE_REACH EDGE_STEPS + 1)
        The share by blur (rows, in steps of BLUR_STEP_U) and by distance from the edge in standard deviations.
    radius_u, blur_u : float
    """
    level = min(blur_u / BLUR_STEP_U, BLUR_LEVELS - 1e-6)
    lower = int(level)
    share = level - lower
    per_u = 1.0 / max(level * BLUR_STEP_U, 1e-9)
    place = ((radius_u - 1.0) * per_u + EDGE_REACH) * EDGE_STEPS
    if place <= 0.0:
        return 1.0, 0.0
    if place >= 2.0 * EDGE_REACH * EDGE_STEPS:
        return 0.0, 0.0
    step = int(place)
    before = table[lower, step] + share * (table[lower + 1, step] - table[lower, step])
    behind = table[lower, step + 1] + share * (table[lower + 1, step + 1] - table[lower, step + 1])
    return before + (place - step) * (behind - before), (behind - before) * EDGE_STEPS * per_u


@compiled("UniTuple(float64, 2)(float64[::1], float64)")
def grey_of(table: Array, light: float) -> tuple[float, float]:
    """Grey value of linear light, both 0 ... 255, and its derivative; what saturates has none."""
    if light <= 0.0:
        return 0.0, 0.0
    if light >= LIGHT_MAX:
        return LIGHT_MAX, 0.0
    place = light * LIGHT_STEPS
    step = int(place)
    slope = table[step + 1] - table[step]
    return table[step] + (place - step) * slope, slope * LIGHT_STEPS
