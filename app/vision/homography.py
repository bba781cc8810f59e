"""Homographies of many plates at once: from the plate, in u with y down as in the picture, to pixels.

``plate coordinates`` here have x to the right and y down, in u, origin at the plate's centre: the target frame with y
turned over, so that plates are not mirrored against the picture.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.targets.layout import dot_centres_u
from app.vision.kernels.homographies import measure_scales, through_all_corners
from app.vision.kernels.refinement import fit_all

Array = npt.NDArray[np.float64]

PLATE_DOTS_U = dot_centres_u() * np.array([1.0, -1.0])  # (16, 2), row-major cells


def image_from_corner_dots(corners_px: Array) -> Array:
    """Homographies, shape (P, 3, 3), that take the corner dots A, B, C, D to pixels of shape (P, 4, 2)."""
    image_from_plate = np.empty((len(corners_px), 3, 3))
    through_all_corners(np.ascontiguousarray(corners_px), image_from_plate)
    return image_from_plate


def fit_homographies(plate_u: Array, image_px: Array, weights: Array) -> Array:
    """Weighted least-squares homographies, shape (P, 3, 3), of N points each.

    Parameters
    ----------
    plate_u : ndarray of shape (N, 2)
    image_px : ndarray of shape (P, N, 2)
    weights : ndarray of shape (P, N)
        0 leaves a point out; at least four points not in line must remain.

    Notes
    -----
    Linear equations with the last element fixed to 1 (plates never reach the horizon). Their residuals are scaled by
    the point's depth, which varies by less than a third over a plate; good enough where residuals are noise.
    """
    image_from_plate = np.empty((len(image_px), 3, 3))
    plate_u, image_px, weights = (np.ascontiguousarray(part) for part in (plate_u, image_px, weights))
    fit_all(plate_u, image_px, weights, image_from_plate)
    return image_from_plate


def apply_homographies(image_from_plate: Array, plate_u: Array) -> Array:
    """Pixels, shape (P, N, 2), of plate points of shape (N, 2) or (P, N, 2)."""
    x, y = plate_u[..., 0], plate_u[..., 1]
    h = image_from_plate[..., None]
    w = h[:, 2, 0] * x + h[:, 2, 1] * y + h[:, 2, 2]
    u = (h[:, 0, 0] * x + h[:, 0, 1] * y + h[:, 0, 2]) / w
    v = (h[:, 1, 0] * x + h[:, 1, 1] * y + h[:, 1, 2]) / w
    return np.stack([u, v], axis=-1)


def homography_jacobians(image_from_plate: Array, plate_u: Array) -> Array:
    """Derivatives of the pixels by the plate coordinates, shape (P, N, 2, 2), px per u."""
    x, y = plate_u[..., 0], plate_u[..., 1]
    h = image_from_plate[..., None]
    w = h[:, 2, 0] * x + h[:, 2, 1] * y + h[:, 2, 2]
    pixels = apply_homographies(image_from_plate, plate_u)
    rows = [[(h[:, i, j] - pixels[..., i] * h[:, 2, j]) / w for j in range(2)] for i in range(2)]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def area_scales(jacobians: Array) -> Array:
    """Square roots of the areas, px^2, that a square u takes, shape (...), for Jacobians of shape (..., 2, 2)."""
    area = jacobians[..., 0, 0] * jacobians[..., 1, 1] - jacobians[..., 0, 1] * jacobians[..., 1, 0]
    result: Array = np.sqrt(np.abs(area))
    return result


def local_px_per_u(image_from_plate: Array) -> Array:
    """Scale at the plates' centres, shape (P,): the square root of the area of a square u in px."""
    px_per_u = np.empty(len(image_from_plate))
    measure_scales(np.ascontiguousarray(image_from_plate), px_per_u)
    return px_per_u


def cross(first: Array, second: Array) -> Array:
    """The plane's cross product of vectors of shape (..., 2); positive when the turn is clockwise in the picture."""
    result: Array = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return result
