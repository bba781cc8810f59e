"""Homographies, one at a time, for other kernels: from plate coordinates (u, y down) to pixels."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]

CORNER_DOT_U = 4.5  # half the distance of two corner dots
LEAST_DETERMINANT = 1e-12  # of corners in line


@compiled("void(float64[:, ::1], float64[:, ::1])")
def through_corners(corners_px: Array, image_from_plate: Array) -> None:
    """The homography, shape (3, 3), written, that takes the corner dots A, B, C, D to pixels of shape (4, 2).

    Closed form of the unit square to a quadrilateral (Heckbert, Fundamentals of Texture Mapping, 1989, section 2.2.3).
    """
    ax, ay, bx, by = corners_px[0, 0], corners_px[0, 1], corners_px[1, 0], corners_px[1, 1]
    cx, cy, dx, dy = corners_px[2, 0], corners_px[2, 1], corners_px[3, 0], corners_px[3, 1]
    closing_x, closing_y = ax - bx + cx - dx, ay - by + cy - dy
    determinant = (bx - cx) * (dy - cy) - (by - cy) * (dx - cx)
    if abs(determinant) < LEAST_DETERMINANT:
        determinant = LEAST_DETERMINANT
    g = (closing_x * (dy - cy) - closing_y * (dx - cx)) / determinant
    h = ((bx - cx) * closing_y - (by - cy) * closing_x) / determinant
    # The square's side is 1 where the plate's dots stand 9 u apart, its corner 0 where A stands at -4.5 u.
    side = 2.0 * CORNER_DOT_U
    first = (bx - ax + g * bx, by - ay + g * by, g)
    second = (dx - ax + h * dx, dy - ay + h * dy, h)
    shift = (ax, ay, 1.0)
    for row in range(3):
        image_from_plate[row, 0] = first[row] / side
        image_from_plate[row, 1] = second[row] / side
        image_from_plate[row, 2] = shift[row] + 0.5 * (first[row] + second[row])


@compiled("UniTuple(float64, 2)(float64[:, ::1], float64, float64)")
def image_of(image_from_plate: Array, x: float, y: float) -> tuple[float, float]:
    """Pixel of a plate point."""
    h = image_from_plate
    share = 1.0 / (h[2, 0] * x + h[2, 1] * y + h[2, 2])
    return (h[0, 0] * x + h[0, 1] * y + h[0, 2]) * share, (h[1, 0] * x + h[1, 1] * y + h[1, 2]) * share


@compiled("UniTuple(float64, 4)(float64[:, ::1], float64, float64)")
def px_by_u_at(image_from_plate: Array, x: float, y: float) -> tuple[float, float, float, float]:
    """Derivatives of the pixel by a plate point, row by row, px per u."""
    h = image_from_plate
    share = 1.0 / (h[2, 0] * x + h[2, 1] * y + h[2, 2])
    u, v = image_of(h, x, y)
    return (
        (h[0, 0] - u * h[2, 0]) * share,
        (h[0, 1] - u * h[2, 1]) * share,
        (h[1, 0] - v * h[2, 0]) * share,
        (h[1, 1] - v * h[2, 1]) * share,
    )


@compiled("float64(float64[:, ::1])")
def px_per_u_of(image_from_plate: Array) -> float:
    """Scale at the plate's centre: the square root of the area of a square u."""
    xx, xy, yx, yy = px_by_u_at(image_from_plate, 0.0, 0.0)
    return np.sqrt(abs(xx * yy - xy * yx))


@compiled("void(float64[:, :, ::1], float64[:, :, ::1])")
def through_all_corners(corners_px: Array, image_from_plate: Array) -> None:
    """``through_corners`` of many plates: corners of shape (P, 4, 2), homographies of shape (P, 3, 3)."""
    for plate in range(len(corners_px)):
        through_corners(corners_px[plate], image_from_plate[plate])


@compiled("void(float64[:, :, ::1], float64[::1])")
def measure_scales(image_from_plate: Array, px_per_u: Array) -> None:
    """``px_per_u_of`` of many plates."""
    for plate in range(len(image_from_plate)):
        px_per_u[plate] = px_per_u_of(image_from_plate[plate])
