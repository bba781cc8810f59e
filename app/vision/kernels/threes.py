"""Three blobs that lie, and look, like E and two corners on one side of a plate, seen from some way off."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

FIRST_ROOM = 256  # rows to begin with; they double as needed


@compiled("UniTuple(float64, 2)(float64, float64, float64, float64)")
def singular_values(xx: float, xy: float, yx: float, yy: float) -> tuple[float, float]:
    """Of a 2 x 2 matrix, the greater first: the semi-axes of a unit circle's image."""
    half_sum = 0.5 * (xx * xx + xy * xy + yx * yx + yy * yy)
    determinant = xx * yy - xy * yx
    part = np.sqrt(max(half_sum * half_sum - determinant * determinant, 0.0))
    return np.sqrt(half_sum + part), np.sqrt(max(half_sum - part, 0.0))


@compiled("boolean(float64[:, ::1], int64[::1], UniTuple(float64, 2), UniTuple(float64, 2))")
def _look_like(semi_axes_px: Array, three: Indices, axes_px: tuple[float, float], bounds: tuple[float, float]) -> bool:
    """Whether three blobs are as long and as wide as the dots of such a plate."""
    off_max, off_px = bounds
    for axis in range(2):
        mean = 0.0
        for blob in three:
            mean += semi_axes_px[blob, axis] / len(three)
        if not abs(mean - axes_px[axis]) < off_max * axes_px[axis] + off_px:
            return False
    return True


@compiled("int64[:, ::1](float64[:, ::1], float64[:, ::1], int64[:, ::1], float64[:, :, ::1], UniTuple(float64, 2))")
def find_threes(
    centres_px: Array, semi_axes_px: Array, nearest: Indices, by_side: Array, bounds: tuple[float, float]
) -> Indices:
    """E, the two corners clockwise, and the side that they are of, shape (M, 4).

    Parameters
    ----------
    centres_px, semi_axes_px : ndarray of shape (N, 2)
    nearest : ndarray of shape (N, K)
        Blobs around each, -1 where there are no more; the corners are among those of E.
    by_side : ndarray of shape (4, 2, 2)
        For each side the inverse of the matrix whose columns lead from E to the two corners, in u.
    bounds : tuple of float
        How far a blob's semi-axes may be off, as part of what they should be and in px besides.
    """
    found, count = np.empty((FIRST_ROOM, 4), dtype=np.int64), 0
    three = np.empty(3, dtype=np.int64)
    for blob in range(len(nearest)):
        for first in nearest[blob]:
            for second in nearest[blob]:
                if first < 0 or second < 0 or first == second:
                    continue
                px, py = centres_px[first, 0] - centres_px[blob, 0], centres_px[first, 1] - centres_px[blob, 1]
                qx, qy = centres_px[second, 0] - centres_px[blob, 0], centres_px[second, 1] - centres_px[blob, 1]
                if px * qy - py * qx <= 0.0:
                    continue  # the other order is clockwise
                three[0], three[1], three[2] = blob, first, second
                for side in range(len(by_side)):
                    inverse = by_side[side]
                    axes_px = singular_values(
                        px * inverse[0, 0] + qx * inverse[1, 0],
                        px * inverse[0, 1] + qx * inverse[1, 1],
                        py * inverse[0, 0] + qy * inverse[1, 0],
                        py * inverse[0, 1] + qy * inverse[1, 1],
                    )
                    if not _look_like(semi_axes_px, three, axes_px, bounds):
                        continue
                    if count == len(found):
                        found = np.concatenate((found, np.empty(found.shape, dtype=np.int64)))
                    found[count, 0], found[count, 1], found[count, 2], found[count, 3] = blob, first, second, side
                    count += 1
    return found[:count]
