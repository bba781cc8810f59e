"""Both poses of a flat target in closed form: homography, its Jacobian at the plate's middle, two rotations from it.

Source: Collins and Bartoli, Infinitesimal Plane-Based Pose Estimation (IPPE), IJCV 109, 2014, section 4. The
decomposition at one point is better conditioned for small plates than that of the whole homography.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# Ridge on the two perspective terms of the homography, as a fraction of a dot's weight. With four dots of which three
# are collinear these terms are free, and the plate is then taken as if seen in parallel projection. It is the square
# root of the machine's precision: too small to move a homography that the dots fix.
PERSPECTIVE_RIDGE = float(np.sqrt(np.finfo(np.float64).eps))


def weighted_mean(values: Array, weights: Array) -> Array:
    """Means over the dots, shape (K, D), of values of shape (K, N, D) under weights of shape (K, N)."""
    return np.asarray((weights[:, None] @ values)[:, 0] / weights.sum(axis=-1)[:, None])


def closed_form_poses(plane_m: Array, normalised: Array, weights: Array) -> tuple[Array, Array]:
    """Rotations, shape (K, 2, 3, 3), and translations, shape (K, 2, 3), ``cam_from_target`` of both solutions.

    Parameters
    ----------
    plane_m, normalised : ndarray of shape (K, N, 2)
        Dots in the target's plane (m) and their image-plane coordinates.
    weights : ndarray of shape (K, N)
        1 for a measured dot, 0 for another; the measured dots of each target are not collinear.
    """
    centred_m = plane_m - weighted_mean(plane_m, weights)[:, None]
    image_of_centre, jacobian = _homography_at_centre(centred_m, normalised, weights)
    rotations = _rotations_of_jacobian(image_of_centre, jacobian)
    turned_m = plane_m[:, None] @ np.swapaxes(rotations[..., :2], -1, -2)
    return rotations, _translations(turned_m, normalised, weights)


def _spread(centred: Array, weights: Array) -> Array:
    """Root mean square distance from the centre, shape (K, 1, 1)."""
    mean_square = weighted_mean((centred**2).sum(axis=-1, keepdims=True), weights)
    return np.sqrt(mean_square)[..., None]


def _homography_at_centre(centred_m: Array, normalised: Array, weights: Array) -> tuple[Array, Array]:
    """Image of the plane's centre, shape (K, 2), and the homography's Jacobian there, shape (K, 2, 2), per m.

    The direct linear transform with h33 = 1, which is the depth of a centre that is seen and so never zero.
    """
    image_mean = weighted_mean(normalised, weights)
    size_m, image_size = _spread(centred_m, weights), _spread(normalised - image_mean[:, None], weights)
    p, q = centred_m / size_m, (normalised - image_mean[:, None]) / image_size
    rows = np.zeros((*p.shape[:-1], 2, 8))  # unknowns h11 h12 h13 h21 h22 h23 h31 h32
    rows[..., 0, 0:2] = rows[..., 1, 3:5] = p
    rows[..., 0, 2] = rows[..., 1, 5] = 1.0
    rows[..., 6:8] = -q[..., :, None] * p[..., None, :]
    rows = rows.reshape(len(p), -1, 8)
    weighted = np.swapaxes(rows * np.repeat(weights, 2, axis=-1)[..., None], -1, -2)
    normal = weighted @ rows
    normal[:, (6, 7), (6, 7)] += PERSPECTIVE_RIDGE
    h = np.linalg.solve(normal, weighted @ q.reshape(len(p), -1, 1))[..., 0]
    centre = h[:, (2, 5)]
    jacobian = np.stack([h[:, 0:2], h[:, 3:5]], axis=-2) - centre[..., :, None] * h[:, None, 6:8]
    return image_mean + image_size[:, 0] * centre, jacobian * image_size / size_m


def _rotations_of_jacobian(image_of_centre: Array, jacobian: Array) -> Array:
    """Both rotations, shape (K, 2, 3, 3), that give the homography's Jacobian (IPPE, section 4.2)."""
    cam_from_ray = _turn_to_ray(image_of_centre)
    foreshortening = cam_from_ray[:, :2, :2] - image_of_centre[:, :, None] * cam_from_ray[:, None, 2, :2]
    a = np.linalg.solve(foreshortening, jacobian)
    norm, determinant = (a**2).sum(axis=(-1, -2)), np.linalg.det(a)
    inverse_depth = np.sqrt(0.5 * (norm + np.sqrt(np.maximum(norm**2 - 4.0 * determinant**2, 0.0))))
    upper = a / inverse_depth[:, None, None]
    rest = np.eye(2) - np.swapaxes(upper, -1, -2) @ upper  # = b b^T: what the upper rows lack to unit columns
    lower = np.sqrt(np.maximum(np.stack([rest[:, 0, 0], rest[:, 1, 1]], axis=-1), 0.0))
    lower[:, 1] *= np.where(rest[:, 0, 1] < 0, -1.0, 1.0)
    columns = np.empty((len(a), 2, 2, 3))
    columns[..., :2] = np.swapaxes(upper, -1, -2)[:, None]
    columns[:, 0, :, 2], columns[:, 1, :, 2] = lower, -lower  # the sign that one view leaves open
    return np.asarray(cam_from_ray[:, None] @ _rotation_of_columns(columns[..., 0, :], columns[..., 1, :]))


def _rotation_of_columns(first: Array, second: Array) -> Array:
    """Proper rotations, shape (..., 3, 3), of nearly orthonormal first two columns, shape (..., 3).

    Noise on a frontal view leaves the columns longer or shorter than one: nothing can be added below them.
    """
    first = first / np.linalg.norm(first, axis=-1, keepdims=True)
    second = second - (first * second).sum(axis=-1, keepdims=True) * first
    second = second / np.linalg.norm(second, axis=-1, keepdims=True)
    return np.stack([first, second, np.cross(first, second)], axis=-1)


def _turn_to_ray(image: Array) -> Array:
    """Rotations, shape (K, 3, 3), that turn the camera's axis (0, 0, 1) into the rays of image points (K, 2)."""
    ray = np.concatenate([image, np.ones((len(image), 1))], axis=-1)
    x, y, z = (ray / np.linalg.norm(ray, axis=-1, keepdims=True)).T
    share = 1.0 / (1.0 + z)
    rows = [1.0 - x * x * share, -x * y * share, x, -x * y * share, 1.0 - y * y * share, y, -x, -y, z]
    return np.stack(rows, axis=-1).reshape(-1, 3, 3)


def _translations(turned_m: Array, normalised: Array, weights: Array) -> Array:
    """Least-squares translations, shape (K, 2, 3), of turned dots (K, 2, N, 3): the rays must meet the dots."""
    x, y = normalised[:, None, :, 0], normalised[:, None, :, 1]
    miss_x = x * turned_m[..., 2] - turned_m[..., 0]
    miss_y = y * turned_m[..., 2] - turned_m[..., 1]
    w = weights[:, None]
    normal = np.zeros((len(turned_m), 1, 3, 3))
    normal[..., 0, 0] = normal[..., 1, 1] = w.sum(axis=-1)
    normal[..., 0, 2] = normal[..., 2, 0] = -(w * x).sum(axis=-1)
    normal[..., 1, 2] = normal[..., 2, 1] = -(w * y).sum(axis=-1)
    normal[..., 2, 2] = (w * (x * x + y * y)).sum(axis=-1)
    right = np.stack([w * miss_x, w * miss_y, -w * (x * miss_x + y * miss_y)], axis=-1).sum(axis=-2)
    return np.linalg.solve(normal, right[..., None])[..., 0]
