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


@compiled("UniTuple(float64, 2)(float64[::1], float64[::1], UniTuple(float64, 5))")
def _along_diagonal(a_px: Array, c_px: Array, bounds: Bounds) -> tuple[float, float]:
    """|EC| over |EA| if C lies beyond E on the line from A, about twice as far, else 0; how much depth may change.

    ``a_px`` and ``c_px`` are the ways from E.
    """
    focal_px, depth_slope, noise_px, lateral_max, lateral_px = bounds
    towards = -(a_px[0] * c_px[0] + a_px[1] * c_px[1])
    if towards <= 0.0:
        return 0.0, 0.0
    square = a_px[0] * a_px[0] + a_px[1] * a_px[1]
    length = np.sqrt(square)
    if abs(a_px[0] * c_px[1] - a_px[1] * c_px[0]) >= lateral_max * towards + lateral_px * length:
        return 0.0, 0.0
    along = towards / square
    # Perspective stretches the far or the near part of a diagonal by no more than the depth changes along it.
    depth_ratio = 1.0 + depth_slope * (1.0 + along) * length / focal_px
    noise = noise_px * (1.0 + POSITION_C) / length
    stands = POSITION_C / depth_ratio - noise < along < POSITION_C * depth_ratio + noise
    return (along, depth_ratio) if stands else (0.0, 0.0)


@compiled("int64(float64[:, ::1], int64, UniTuple(int64, 2), UniTuple(float64, 8), int64[:, :])")
def _face_each_other(ways_px: Array, around: int, line: tuple[int, int], bounds: Bounds, found: Indices) -> int:
    """Slots of A, B, C, D of which B and D face each other through f, B clockwise from A, written; their number.

    All as ways from E; ``line`` holds A and C, ``bounds`` begins with f's place and how much depth may change.
    """
    fx, fy, depth_ratio, noise_px, facing_max, facing_px, least, most = bounds
    a, c = line
    ax, ay = ways_px[a, 0] - fx, ways_px[a, 1] - fy
    half_px = np.sqrt(ax * ax + ay * ay)
    nearest, farthest = (least * half_px) ** 2, (most * half_px) ** 2
    count = 0
    for b in range(around):
        bx, by = ways_px[b, 0] - fx, ways_px[b, 1] - fy
        square_b = bx * bx + by * by
        if b in (a, c) or ax * by - ay * bx <= 0.0 or square_b <= nearest or square_b >= farthest:
            continue
        for d in range(around):
            dx, dy = ways_px[d, 0] - fx, ways_px[d, 1] - fy
            square_d = dx * dx + dy * dy
            if d in (a, c) or bx * dx + by * dy >= 0.0 or ax * dy - ay * dx >= 0.0:
                continue
            if square_d <= nearest or square_d >= farthest:
                continue
            shorter, longer = np.sqrt(min(square_b, square_d)), np.sqrt(max(square_b, square_d))
            sine = abs(bx * dy - by * dx) / (shorter * longer)
            if longer < depth_ratio * shorter + noise_px and sine < facing_max + facing_px / shorter:
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = a, b, c, d
                count += 1
    return count


@compiled("int64(float64[:, ::1], int64[:, ::1], int64, float64[:, ::1])")
def _ways_from(centres_px: Array, nearest: Indices, e: int, ways_px: Array) -> int:
    """The ways from E to the blobs around it, written; how many there are."""
    around = 0
    while around < nearest.shape[1] and nearest[e, around] >= 0:
        ways_px[around, 0] = centres_px[nearest[e, around], 0] - centres_px[e, 0]
        ways_px[around, 1] = centres_px[nearest[e, around], 1] - centres_px[e, 1]
        around += 1
    return around


@compiled("int64(float64[:, ::1], int64, int64, UniTuple(float64, 9), int64[:, ::1])")
def _plates_with(ways_px: Array, around: int, a: int, bounds: Bounds, found: Indices) -> int:
    """Slots of A, B, C, D around an E with a given A, written; their number."""
    focal_px, slope, noise_px, lateral_max, lateral_px, facing_max, facing_px, least, most = bounds
    line = (focal_px, slope, noise_px, lateral_max, lateral_px)
    count = 0
    for c in range(around):
        along, depth_ratio = _along_diagonal(ways_px[a], ways_px[c], line)
        if along > 0.0:
            share = _share_of_crossing(along)
            fx = ways_px[a, 0] + share * (ways_px[c, 0] - ways_px[a, 0])
            fy = ways_px[a, 1] + share * (ways_px[c, 1] - ways_px[a, 1])
            faces = (fx, fy, depth_ratio, noise_px, facing_max, facing_px, least, most)
            count += _face_each_other(ways_px, around, (a, c), faces, found[count:])
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
    found = np.empty((most**3, BASE_DOTS - 1), dtype=np.int64)
    count = 0
    for e in range(len(nearest)):
        around = _ways_from(centres_px, nearest, e, ways_px)
        for a in range(min(nearest_a, around)):
            pitch = np.sqrt(ways_px[a, 0] ** 2 + ways_px[a, 1] ** 2) / major_px[e]
            if not bounds[0] < pitch < bounds[1]:
                continue
            added = _plates_with(ways_px, around, a, bounds[2:], found)
            while count + added > len(groups):
                groups = np.concatenate((groups, np.empty(groups.shape, dtype=np.int64)))
            for place in range(added):
                for dot in range(BASE_DOTS - 1):
                    groups[count, dot] = nearest[e, found[place, dot]]
                groups[count, BASE_DOTS - 1] = e
                count += 1
    return groups[:count]
