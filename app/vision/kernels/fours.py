"""Four blobs that lie like four of a plate's five base dots."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

FOUR = 4
FIRST_ROOM = 1024  # rows to begin with; they double as needed


@compiled("boolean(int64[:, ::1], int64, int64[::1])")
def _is_around(nearest: Indices, blob: int, four: Indices) -> bool:
    """Whether the other three of four blobs are among one's neighbours."""
    around = 0
    for neighbour in nearest[blob]:
        for other in four:
            around += neighbour == other
    return around == FOUR - 1


@compiled("boolean(int64[:, ::1], int64, int64[::1])")
def _is_known(nearest: Indices, blob: int, four: Indices) -> bool:
    """Whether an earlier one of four blobs has the others around it, too."""
    known = 0
    for other in four:
        known += other < blob and _is_around(nearest, int(other), four)
    return known > 0


@compiled("boolean(float64[:, ::1], float64[:, ::1], int64[::1], float64)")
def _is_compact(centres_px: Array, semi_axes_px: Array, four: Indices, extent_axes: float) -> bool:
    """Whether four blobs stand no farther apart than a plate's."""
    left, top, right, bottom, major = np.inf, np.inf, -np.inf, -np.inf, 0.0
    for blob in four:
        x, y = centres_px[blob]
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
        major += semi_axes_px[blob, 0] / FOUR
    return np.sqrt((right - left) ** 2 + (bottom - top) ** 2) < extent_axes * major


@compiled("int64[:, ::1](float64[:, ::1], float64[:, ::1], int64[:, ::1], float64)")
def find_fours(centres_px: Array, semi_axes_px: Array, nearest: Indices, extent_axes: float) -> Indices:
    """Sets of four blobs that stand together, shape (M, 4), ascending, each set once.

    Parameters
    ----------
    centres_px, semi_axes_px : ndarray of shape (N, 2)
    nearest : ndarray of shape (N, K)
        Blobs around each, -1 where there are no more; the other three are among one's neighbours.
    extent_axes : float
        Farthest that two may stand apart, in major semi-axes.
    """
    fours, four = np.empty((FIRST_ROOM, FOUR), dtype=np.int64), np.empty(FOUR, dtype=np.int64)
    count, slots = 0, nearest.shape[1]
    for blob in range(len(nearest)):
        for first in range(slots):
            for second in range(first + 1, slots):
                for third in range(second + 1, slots):
                    if nearest[blob, third] < 0:
                        break
                    four[0], four[1] = blob, nearest[blob, first]
                    four[2], four[3] = nearest[blob, second], nearest[blob, third]
                    if not _is_compact(centres_px, semi_axes_px, four, extent_axes):
                        continue
                    if _is_known(nearest, blob, four):
                        continue
                    if count == len(fours):
                        fours = np.concatenate((fours, np.empty(fours.shape, dtype=np.int64)))
                    fours[count] = np.sort(four)
                    count += 1
    return fours[:count]


@compiled("int64[:, ::1](float64[:, ::1], float64[:, ::1], int64[:, ::1], float64[:, ::1], float64)")
def match_relations(
    centres_px: Array, semi_axes_px: Array, fours: Indices, relations: Array, limit_axes: float
) -> Indices:
    """Four and relation of each match, shape (N, 2): the weighted sum of the four's centres nearly vanishes.

    Parameters
    ----------
    relations : ndarray of shape (R, 4)
        Weights whose sum is zero.
    limit_axes : float
        How far the sum may be off, in the four's mean major semi-axis.
    """
    matches, count = np.empty((FIRST_ROOM, 2), dtype=np.int64), 0
    for number in range(len(fours)):
        four, major = fours[number], 0.0
        for blob in four:
            major += semi_axes_px[blob, 0] / FOUR
        for relation in range(len(relations)):
            x, y = 0.0, 0.0
            for place in range(FOUR):
                x += relations[relation, place] * centres_px[four[place], 0]
                y += relations[relation, place] * centres_px[four[place], 1]
            if x * x + y * y < (limit_axes * major) ** 2:
                if count == len(matches):
                    matches = np.concatenate((matches, np.empty(matches.shape, dtype=np.int64)))
                matches[count, 0], matches[count, 1] = number, relation
                count += 1
    return matches[:count]
