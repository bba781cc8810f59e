"""Homographies of many plates at once: from the plate, in u with y down as in the picture, to pixels.

``plate coordinates`` here have x to the right and y down, in u, origin at the plate's centre: the target frame with y
turned over, so that plates are not mirrored against the picture.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.targets.layout import DOT_PITCH_U, dot_centres_u

Array = npt.NDArray[np.float64]

CORNER_DOT_U = 1.5 * DOT_PITCH_U  # the corner dots stand at +- 4.5 u
CENTRE_U = np.zeros((1, 2))
PLATE_DOTS_U = dot_centres_u() * np.array([1.0, -1.0])  # (16, 2), row-major cells


def image_from_corner_dots(corners_px: Array) -> Array:
    """Homographies, shape (P, 3, 3), that take the corner dots A, B, C, D to pixels of shape (P, 4, 2).

    Closed form of the unit square to a quadrilateral (Heckbert, Fundamentals of Texture Mapping, 1989, section 2.2.3).
    """
    a, b, c, d = np.moveaxis(corners_px, 1, 0)
    from_b, from_d, closing = b - c, d - c, a - b + c - d
    determinant = cross(from_b, from_d)
    safe = np.where(np.abs(determinant) < 1e-12, 1e-12, determinant)
    g, h = cross(closing, from_d) / safe, cross(from_b, closing) / safe
    image_from_square = np.empty((len(corners_px), 3, 3))
    image_from_square[:, :2, 0] = b - a + g[:, None] * b
    image_from_square[:, :2, 1] = d - a + h[:, None] * d
    image_from_square[:, :2, 2] = a
    image_from_square[:, 2] = np.stack([g, h, np.ones_like(g)], axis=1)
    side = 2.0 * CORNER_DOT_U
    square_from_plate = np.array([[1.0 / side, 0.0, 0.5], [0.0, 1.0 / side, 0.5], [0.0, 0.0, 1.0]])
    result: Array = image_from_square @ square_from_plate
    return result


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
    centroid_px = (weights[..., None] * image_px).sum(axis=1) / weights.sum(axis=1)[:, None]
    u, v = np.moveaxis(image_px - centroid_px[:, None], 2, 0)
    x, y = np.broadcast_to(plate_u.T[:, None], (2, *u.shape))
    one, zero = np.ones_like(u), np.zeros_like(u)
    rows_u = np.stack([x, y, one, zero, zero, zero, -u * x, -u * y], axis=-1)
    rows_v = np.stack([zero, zero, zero, x, y, one, -v * x, -v * y], axis=-1)
    design, observed = np.concatenate([rows_u, rows_v], axis=1), np.concatenate([u, v], axis=1)
    weighted = design.transpose(0, 2, 1) * np.concatenate([weights, weights], axis=1)[:, None]
    normals = weighted @ design
    # Points in line leave the plate's other direction open: a trace of a ridge keeps it finite, and the plate unlikely.
    ridge = 1e-12 * np.einsum("pii->p", normals)[:, None, None] * np.eye(8)
    elements = np.linalg.solve(normals + ridge, weighted @ observed[..., None])[..., 0]
    image_from_plate = np.concatenate([elements, np.ones((len(elements), 1))], axis=1).reshape(-1, 3, 3)
    # Undo the shift to the centroid.
    image_from_plate[:, :2] += centroid_px[:, :, None] * image_from_plate[:, 2:]
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
    return area_scales(homography_jacobians(image_from_plate, CENTRE_U))[:, 0]


def cross(first: Array, second: Array) -> Array:
    """The plane's cross product of vectors of shape (..., 2); positive when the turn is clockwise in the picture."""
    result: Array = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return result
