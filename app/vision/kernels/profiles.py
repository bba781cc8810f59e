"""What pixels should show: the blurred edge of a dot, and the grey value of light, many pixels at once.

Each loop runs on vector registers in single precision, which places a dot to 1e-5 of a pixel.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array32 = npt.NDArray[np.float32]
Indices32 = npt.NDArray[np.int32]

EDGE_REACH = 6.0  # standard deviations of the blur on either side of a dot's edge: beyond is nothing to see
EDGE_STEPS = 20  # per standard deviation
EDGE_PLACES = 2 * int(EDGE_REACH) * EDGE_STEPS + 1
BLUR_STEP_U = 0.01  # between levels: the nearest one's profile is 1e-3 off at most
BLUR_LEVELS = 150  # up to 1.5 u: a picture of 1 px per u, or seen at a grazing angle
LIGHT_MAX = 255.0
AWAY_MIN = np.float32(1e-6)  # u: in the very middle of a dot no direction leads to its edge
BLUR_MIN = np.float32(1e-3)  # u: as good as none
ZERO, ONE, HALF = np.float32(0.0), np.float32(1.0), np.float32(0.5)


@compiled("void(float32[:, ::1], UniTuple(float32, 7), float32[:, ::1], int32[::1], float32[:, ::1])")
def edge_profiles(
    offsets: Array32, seen: tuple[np.float32, ...], table: Array32, places: Indices32, written: Array32
) -> None:
    """Share of a unit disc's light at N places, and its derivatives by a motion of the disc in the picture.

    Parameters
    ----------
    offsets : ndarray of shape (2, M), float32
        Places, plate coordinates, M >= N.
    seen : tuple of float32
        The disc's centre in the same coordinates; their derivatives by the picture, row by row, u per px; and
        the blur's standard deviation in px.
    table : ndarray of shape ((BLUR_LEVELS + 1) * EDGE_PLACES, 2), float32
        Level by level and place by place: the share, and what it grows by up to the next place.
    places : ndarray of shape (N,), int32
        Room for the work: its length says how many there are.
    written : ndarray of shape (3, M), float32
        Share, and its derivatives by x and y of the disc's centre, per px.
    """
    middle_x, middle_y, xx, xy, yx, yy, blur_px = seen
    along, down, share, by_x, by_y = offsets[0], offsets[1], written[0], written[1], written[2]
    last = np.float32(EDGE_PLACES - 1.001)
    for at in range(len(places)):
        x, y = along[at] - middle_x, down[at] - middle_y
        away = max(np.sqrt(x * x + y * y), AWAY_MIN)
        towards_x, towards_y = (x * xx + y * yx) / away, (x * xy + y * yy) / away
        blur_u = blur_px * np.sqrt(towards_x * towards_x + towards_y * towards_y)
        level = np.int32(min(blur_u * np.float32(1.0 / BLUR_STEP_U) + HALF, np.float32(BLUR_LEVELS)))
        per_u = ONE / max(blur_u, BLUR_MIN)
        place = ((away - ONE) * per_u + np.float32(EDGE_REACH)) * np.float32(EDGE_STEPS)
        place = min(max(place, ZERO), last)
        step = np.float32(np.int32(place))
        places[at] = np.int32(np.float32(level) * np.float32(EDGE_PLACES) + step)
        share[at] = place - step
        # A disc that moves towards a place shortens its distance from it.
        by_x[at] = -towards_x * per_u * np.float32(EDGE_STEPS)
        by_y[at] = -towards_y * per_u * np.float32(EDGE_STEPS)
    for at in range(len(places)):
        entry = np.uint32(places[at])
        slope = table[entry, 1]
        share[at] = table[entry, 0] + share[at] * slope
        by_x[at] *= slope
        by_y[at] *= slope


@compiled("void(float32[::1], int64, float32[::1], float32[::1])")
def grey_values(curve: Array32, count: int, light: Array32, slopes: Array32) -> None:
    """Linear light to grey values in place, both 0 ... 255, with derivatives; what saturates has none.

    Parameters
    ----------
    curve : ndarray of shape (7,), float32
        Factors of light's roots (second, fourth, eighth), of light and of one in sRGB's curve; where it begins, and
        the slope of the straight line before.
    count : int
        How many there are.
    light, slopes : ndarray of shape (M,), float32, written
    """
    most, begins, straight = np.float32(LIGHT_MAX), curve[5], curve[6]
    by_second, by_fourth, by_eighth = HALF * curve[0], np.float32(0.25) * curve[1], np.float32(0.125) * curve[2]
    for at in range(count):
        shown = min(max(light[at], ZERO), most)
        bent = max(shown, begins)
        second = np.sqrt(bent)
        fourth = np.sqrt(second)
        eighth = np.sqrt(fourth)
        grey = curve[0] * second + curve[1] * fourth + curve[2] * eighth + curve[3] * bent + curve[4]
        slope = (by_second * second + by_fourth * fourth + by_eighth * eighth) / bent + curve[3]
        slope = straight if shown < begins else slope
        slopes[at] = slope if shown == light[at] else ZERO
        light[at] = straight * shown if shown < begins else grey


@compiled("void(float32[::1], UniTuple(float32, 2), float32[:, ::1], int32[::1], float32[::1])")
def straight_profile(
    offsets: Array32, seen: tuple[np.float32, np.float32], table: Array32, places: Indices32, written: Array32
) -> None:
    """Share of a half-plane's light at N places, ``seen[0] + seen[1] * offset`` standard deviations before its edge.

    The rest is as for ``edge_profiles``.
    """
    before, by_offset = seen
    last = np.float32(EDGE_PLACES - 1.001)
    for at in range(len(places)):
        place = (before + by_offset * offsets[at] + np.float32(EDGE_REACH)) * np.float32(EDGE_STEPS)
        place = min(max(place, ZERO), last)
        places[at] = np.int32(place)
        written[at] = place - np.float32(np.int32(place))
    for at in range(len(places)):
        entry = np.uint32(places[at])
        written[at] = table[entry, 0] + written[at] * table[entry, 1]
