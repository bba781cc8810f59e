"""Three blobs that lie, and look, like E and two corners on one side of a plate, seen from some way off."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.gaps import red_at
from app.vision.kernels.ordering import middle_of

Array = npt.NDArray[np.float64]
Light = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]
Pixels = npt.NDArray[np.uint8]

FIRST_ROOM = 256  # rows to begin with; they double as needed


@compiled("UniTuple(float64, 2)(float64, float64, float64, float64)")
def singular_values(xx: float, xy: float, yx: float, yy: float) -> tuple[float, float]:
    """Of a 2 x 2 matrix, the greater first: the semi-axes of a unit circle's image."""
    half_sum = 0.5 * (xx * xx + xy * xy + yx * yx + yy * yy)
    determinant = xx * yy - xy * yx
    part = np.sqrt(max(half_sum * half_sum - determinant * determinant, 0.0))
    return np.sqrt(half_sum + part), np.sqrt(max(half_sum - part, 0.0))


@compiled("UniTuple(float64, 2)(float64[:, ::1], UniTuple(int64, 3))")
def _mean_axes(semi_axes_px: Array, three: tuple[int, int, int]) -> tuple[float, float]:
    """Semi-axes of three blobs, on the average."""
    a, b, c = semi_axes_px[three[0]], semi_axes_px[three[1]], semi_axes_px[three[2]]
    return (a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0


@compiled("boolean(UniTuple(float64, 2), UniTuple(float64, 2), UniTuple(float64, 2))")
def _look_like(mean_px: tuple[float, float], axes_px: tuple[float, float], bounds: tuple[float, float]) -> bool:
    """Whether blobs are as long and as wide as the dots of such a plate."""
    off_max, off_px = bounds
    long_off_px, wide_off_px = abs(mean_px[0] - axes_px[0]), abs(mean_px[1] - axes_px[1])
    return bool(long_off_px < off_max * axes_px[0] + off_px and wide_off_px < off_max * axes_px[1] + off_px)


@compiled("UniTuple(float64, 2)(UniTuple(float64, 2), UniTuple(float64, 2))")
def _areas_like(mean_px: tuple[float, float], bounds: tuple[float, float]) -> tuple[float, float]:
    """Least and greatest product of two semi-axes that such blobs look like: tells most threes without a root."""
    off_max, off_px = bounds
    least = max(mean_px[0] - off_px, 0.0) * max(mean_px[1] - off_px, 0.0) / (1.0 + off_max) ** 2
    return least, (mean_px[0] + off_px) * (mean_px[1] + off_px) / (1.0 - off_max) ** 2


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
    per_area = np.abs(by_side[:, 0, 0] * by_side[:, 1, 1] - by_side[:, 0, 1] * by_side[:, 1, 0])
    for blob in range(len(nearest)):
        for first in nearest[blob]:
            for second in nearest[blob]:
                if first < 0 or second < 0 or first == second:
                    continue
                px, py = centres_px[first, 0] - centres_px[blob, 0], centres_px[first, 1] - centres_px[blob, 1]
                qx, qy = centres_px[second, 0] - centres_px[blob, 0], centres_px[second, 1] - centres_px[blob, 1]
                turn = px * qy - py * qx
                if turn <= 0.0:
                    continue  # the other order is clockwise
                mean_px = _mean_axes(semi_axes_px, (blob, first, second))
                least, most = _areas_like(mean_px, bounds)
                for side in range(len(by_side)):
                    if not least <= turn * per_area[side] <= most:
                        continue
                    inverse = by_side[side]
                    axes_px = singular_values(
                        px * inverse[0, 0] + qx * inverse[1, 0],
                        px * inverse[0, 1] + qx * inverse[1, 1],
                        py * inverse[0, 0] + qy * inverse[1, 0],
                        py * inverse[0, 1] + qy * inverse[1, 1],
                    )
                    if not _look_like(mean_px, axes_px, bounds):
                        continue
                    if count == len(found):
                        found = np.concatenate((found, np.empty(found.shape, dtype=np.int64)))
                    found[count, 0], found[count, 1], found[count, 2], found[count, 3] = blob, first, second, side
                    count += 1
    return found[:count]


@compiled(
    "void(int64[:, ::1], Tuple((float64[:, ::1], float64[:, ::1])), Tuple((float64[:, :, ::1], float64[:, :, ::1])), "
    "int64[:, ::1], float64[:, ::1], float64[:, ::1])"
)
def make_up_corners(
    threes: Indices,
    pool: tuple[Array, Array],
    by_side: tuple[Array, Array],
    groups: Indices,
    centres_px: Array,
    semi_axes_px: Array,
) -> None:
    """Where the two hidden corners of each three are, by the affinity through the three, and how large.

    Parameters
    ----------
    threes : ndarray of shape (M, 4)
        As ``find_threes`` gives them.
    pool : tuple of ndarray
        Blobs' centres and semi-axes, shape (N, 2).
    by_side : tuple of ndarray
        For each side that is seen the matrix of ``find_threes``, and what leads from E to the corners across, u.
    groups : ndarray of shape (M, 5), written
        A, B, C, D, E: blobs, and, behind them, what is made up.
    centres_px, semi_axes_px : ndarray of shape (2 * M, 2), written
    """
    centres, axes = pool
    for row in range(len(threes)):
        blob, first, second, side = threes[row]
        inverse, count = by_side[0][side], len(centres) + 2 * row
        groups[row, 4], groups[row, side], groups[row, (side + 1) % 4] = blob, first, second
        groups[row, (side + 2) % 4], groups[row, (side + 3) % 4] = count, count + 1
        for axis in range(2):
            p, q = centres[first, axis] - centres[blob, axis], centres[second, axis] - centres[blob, axis]
            along, down = p * inverse[0, 0] + q * inverse[1, 0], p * inverse[0, 1] + q * inverse[1, 1]
            size_px = (axes[blob, axis] + axes[first, axis] + axes[second, axis]) / 3.0
            for corner in range(2):
                offset_u = by_side[1][side, corner]
                centres_px[2 * row + corner, axis] = centres[blob, axis] + along * offset_u[0] + down * offset_u[1]
                semi_axes_px[2 * row + corner, axis] = size_px


@compiled("void(uint8[:, :, ::1], float32[::1], float64[:, :, ::1], float64[::1])")
def measure_reds(bgr: Pixels, light: Light, base_px: Array, red: Array) -> None:
    """Red of the third brightest of five dots, linear light, written for each group: ``base_px`` is (G, 5, 2)."""
    five = np.empty(base_px.shape[1])
    for group in range(len(base_px)):
        for dot in range(len(five)):
            five[dot] = light[int(red_at(bgr, base_px[group, dot, 0], base_px[group, dot, 1]) + 0.5)]
        red[group] = middle_of(five)
