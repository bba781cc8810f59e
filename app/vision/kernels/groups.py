"""Five blobs that lie like a plate's base dots: each as E, with A, C, then B and D from its neighbours."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

# Positions along the diagonal in its own pitch, E at 0 and A at -1.
POSITION_F, POSITION_C = 0.5, 2.0

FIRST_GROUPS = 1024  # room to begin with; it doubles as needed
BASE_DOTS = 5

Bounds = tuple[float, ...]


@compiled("float64(float64)")
def _share_of_crossing(s: float) -> float:
    """Where on the way from A to C the diagonals cross, if |EC| is ``s`` times |EA|."""
    # x -> alpha x / (1 + beta x) takes -1, 0, 2 to -1, 0, s.
    beta = (POSITION_C - s) / (POSITION_C * (1.0 + s))
    position_f = (1.0 - beta) * POSITION_F / (1.0 + beta * POSITION_F)
    return (position_f + 1.0) / (s + 1.0)


@compiled("UniTuple(float64, 2)(UniTuple(float64, 4), UniTuple(float64, 2), UniTuple(float64, 5))")
def _along_diagonal(a_px: tuple[float, ...], c_px: tuple[float, float], bounds: Bounds) -> tuple[float, float]:
    """|EC| over |EA| if C lies beyond E on the line from A, about twice as far, else 0; how much depth may change.

    ``a_px`` and ``c_px`` are the ways from E, the first with its square and its length.
    """
    focal_px, depth_slope, noise_px, lateral_max, lateral_px = bounds
    ax, ay, square, length = a_px
    towards = -(ax * c_px[0] + ay * c_px[1])
    if towards <= 0.0 or abs(ax * c_px[1] - ay * c_px[0]) >= lateral_max * towards + lateral_px * length:
        return 0.0, 0.0
    along = towards / square
    # Perspective stretches the far or the near part of a diagonal by no more than the depth changes along it.
    depth_ratio = 1.0 + depth_slope * (1.0 + along) * length / focal_px
    noise = noise_px * (1.0 + POSITION_C) / length
    stands = POSITION_C / depth_ratio - noise < along < POSITION_C * depth_ratio + noise
    return (along, depth_ratio) if stands else (0.0, 0.0)


@compiled("UniTuple(int64, 2)(float64[:, ::1], int64, UniTuple(int64, 2), UniTuple(float64, 4), float64[:, :, ::1])")
def _part_sides(ways_px: Array, around: int, line: tuple[int, int], bounds: Bounds, sides: Array) -> tuple[int, int]:
    """Blobs on either side of the line from A to C, within reach of f: slot, way from f and its square, written.

    Those clockwise from A come first; returns how many there are on each side.
    """
    fx, fy, least, most = bounds
    a, c = line
    ax, ay = ways_px[a, 0] - fx, ways_px[a, 1] - fy
    half2 = ax * ax + ay * ay
    nearest, farthest = least * least * half2, most * most * half2
    right, left = 0, 0
    for slot in range(around):
        x, y = ways_px[slot, 0] - fx, ways_px[slot, 1] - fy
        square, side = x * x + y * y, ax * y - ay * x
        if square <= nearest or square >= farthest or side == 0.0 or slot in (a, c):
            continue
        number = right if side > 0.0 else left
        entry = sides[0 if side > 0.0 else 1, number]
        entry[0], entry[1], entry[2], entry[3] = slot, x, y, square
        right, left = right + (side > 0.0), left + (side < 0.0)
    return right, left


@compiled("boolean(float64[::1], float64[::1], UniTuple(float64, 4))")
def _face_each_other(b: Array, d: Array, bounds: Bounds) -> bool:
    """Whether two blobs, as ``_part_sides`` leaves them, lie on opposite sides of f, about equally far."""
    depth_ratio, noise_px, facing_max, facing_px = bounds
    if b[1] * d[1] + b[2] * d[2] >= 0.0:
        return False
    shorter, longer = np.sqrt(min(b[3], d[3])), np.sqrt(max(b[3], d[3]))
    if longer >= depth_ratio * shorter + noise_px:
        return False
    sine = abs(b[1] * d[2] - b[2] * d[1]) / (shorter * longer)
    return sine < facing_max + facing_px / shorter


@compiled("int64(float64[:, ::1], int64[:, ::1], int64, float64[:, ::1])")
def _ways_from(centres_px: Array, nearest: Indices, e: int, ways_px: Array) -> int:
    """The ways from E to the blobs around it, written; how many there are."""
    around = 0
    while around < nearest.shape[1] and nearest[e, around] >= 0:
        ways_px[around, 0] = centres_px[nearest[e, around], 0] - centres_px[e, 0]
        ways_px[around, 1] = centres_px[nearest[e, around], 1] - centres_px[e, 1]
        around += 1
    return around


@compiled("int64(float64[:, ::1], int64, int64, UniTuple(float64, 9), Tuple((float64[:, :, ::1], int64[:, ::1])))")
def _plates_with(ways_px: Array, around: int, a: int, bounds: Bounds, room: tuple[Array, Indices]) -> int:
    """Slots of A, B, C, D around an E with a given A, written; their number."""
    focal_px, slope, noise_px, lateral_max, lateral_px, facing_max, facing_px, least, most = bounds
    line, (sides, found) = (focal_px, slope, noise_px, lateral_max, lateral_px), room
    ax, ay, count = ways_px[a, 0], ways_px[a, 1], 0
    square = ax * ax + ay * ay
    way_to_a = (ax, ay, square, np.sqrt(square))
    for c in range(around):
        cx, cy = ways_px[c, 0], ways_px[c, 1]
        along, depth_ratio = _along_diagonal(way_to_a, (cx, cy), line)
        if along <= 0.0:
            continue
        share = _share_of_crossing(along)
        reach = (ax + share * (cx - ax), ay + share * (cy - ay), least, most)
        right, left = _part_sides(ways_px, around, (a, c), reach, sides)
        for b in range(right):
            for d in range(left):
                if _face_each_other(sides[0, b], sides[1, d], (depth_ratio, noise_px, facing_max, facing_px)):
                    found[count, 0], found[count, 1] = a, np.int64(sides[0, b, 0])
                    found[count, 2], found[count, 3] = c, np.int64(sides[1, d, 0])
                    count += 1
    return count


@compiled("int64[:, ::1](float64[:, ::1], float64[::1], int64[:, ::1], UniTuple(float64, 11), int64)")
def find_groups(centres_px: Array, major_px: Array, nearest: Indices, bounds: Bounds, nearest_a: int) -> Indices:
    """Candidates A, B, C, D, E as blob indices, shape (G, 5).

    Parameters
    ----------
    centres_px : ndarray of shape (N, 2)
    major_px : ndarray of shape (N,)
        Major semi-axes.
    nearest : ndarray of shape (N, K)
        Blobs around each, nearest first, -1 where there are no more.
    bounds : tuple of float
        Both of ``GroupingOptions.diagonal_pitch_axes``, the least focal length in px, then of the options depth_slope,
        noise_px, lateral_max, lateral_px, facing_max, facing_px, both of reach.
    nearest_a : int
        A is among so many of the nearest.
    """
    most = nearest.shape[1]
    groups, ways_px = np.empty((FIRST_GROUPS, BASE_DOTS), dtype=np.int64), np.empty((most, 2))
    room = (np.empty((2, most, 4)), np.empty((most**3, BASE_DOTS - 1), dtype=np.int64))
    count = 0
    for e in range(len(nearest)):
        around = _ways_from(centres_px, nearest, e, ways_px)
        for a in range(min(nearest_a, around)):
            pitch = np.sqrt(ways_px[a, 0] ** 2 + ways_px[a, 1] ** 2) / major_px[e]
            if not bounds[0] < pitch < bounds[1]:
                continue
            added = _plates_with(ways_px, around, a, bounds[2:], room)
            while count + added > len(groups):
                groups = np.concatenate((groups, np.empty(groups.shape, dtype=np.int64)))
            for place in range(added):
                for dot in range(BASE_DOTS - 1):
                    groups[count, dot] = nearest[e, room[1][place, dot]]
                groups[count, BASE_DOTS - 1] = e
                count += 1
    return groups[:count]
