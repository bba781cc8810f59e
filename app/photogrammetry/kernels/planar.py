"""Both poses of a flat target in closed form: homography, its Jacobian at the plate's middle, two rotations from it.

Source: Collins and Bartoli, Infinitesimal Plane-Based Pose Estimation (IPPE), IJCV 109, 2014, section 4. The
decomposition at one point is better conditioned for small plates than that of the whole homography.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.symmetric import solve_symmetric

Array = npt.NDArray[np.float64]

ELEMENTS = 8  # of a homography whose last is 1
# Ridge on the two perspective terms of the homography, as a fraction of a dot's weight. With four dots of which three
# are collinear these terms are free, and the plate is then taken as if seen in parallel projection. It is the square
# root of the machine's precision: too small to move a homography that the dots fix.
PERSPECTIVE_RIDGE = float(np.sqrt(np.finfo(np.float64).eps))


@compiled("UniTuple(float64, 3)(float64[:, ::1], float64[::1])")
def _middle_and_spread(points: Array, weights: Array) -> tuple[float, float, float]:
    """Weighted mean of points of shape (N, 2), and their root mean square distance from it."""
    total, x, y, square = 0.0, 0.0, 0.0, 0.0
    for point in range(len(weights)):
        total += weights[point]
        x += weights[point] * points[point, 0]
        y += weights[point] * points[point, 1]
    x, y = x / total, y / total
    for point in range(len(weights)):
        square += weights[point] * ((points[point, 0] - x) ** 2 + (points[point, 1] - y) ** 2)
    return x, y, np.sqrt(square / total)


@compiled("void(float64[:, ::1], float64[:, ::1], float64[::1], float64[::1])")
def _fit_homography(plane: Array, image: Array, weights: Array, elements: Array) -> None:
    """Direct linear transform with h33 = 1, the depth of a centre that is seen and so never zero; (8,), written.

    Both sets of points are taken from their mean and in units of their spread.
    """
    plane_x, plane_y, plane_size = _middle_and_spread(plane, weights)
    image_x, image_y, image_size = _middle_and_spread(image, weights)
    normals, row = np.zeros((ELEMENTS, ELEMENTS)), np.zeros(ELEMENTS)
    elements[:] = 0.0
    for point in range(len(weights)):
        if weights[point] == 0.0:
            continue
        p, q = (plane[point, 0] - plane_x) / plane_size, (plane[point, 1] - plane_y) / plane_size
        for axis in range(2):
            observed = (image[point, axis] - (image_y if axis else image_x)) / image_size
            row[:] = 0.0
            row[3 * axis], row[3 * axis + 1], row[3 * axis + 2] = p, q, 1.0
            row[6], row[7] = -observed * p, -observed * q
            for first in range(ELEMENTS):
                elements[first] += weights[point] * row[first] * observed
                for second in range(first + 1):
                    normals[first, second] += weights[point] * row[first] * row[second]
    normals[6, 6] += PERSPECTIVE_RIDGE
    normals[7, 7] += PERSPECTIVE_RIDGE
    solve_symmetric(normals, elements)


@compiled("void(float64, float64, float64[:, ::1])")
def _turn_to_ray(x: float, y: float, turn: Array) -> None:
    """The rotation, written, that turns the camera's axis (0, 0, 1) into the ray of an image point."""
    length = np.sqrt(x * x + y * y + 1.0)
    x, y, z = x / length, y / length, 1.0 / length
    share = 1.0 / (1.0 + z)
    turn[0, 0], turn[0, 1], turn[0, 2] = 1.0 - x * x * share, -x * y * share, x
    turn[1, 0], turn[1, 1], turn[1, 2] = -x * y * share, 1.0 - y * y * share, y
    turn[2, 0], turn[2, 1], turn[2, 2] = -x, -y, z


@compiled("void(float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1])")
def _write_rotation(turn: Array, upper: Array, lower: Array, rotation: Array) -> None:
    """A proper rotation, written, of nearly orthonormal first two columns, turned to the ray.

    Noise on a frontal view leaves the columns longer or shorter than one: nothing can be added below them.
    """
    columns = np.empty((3, 3))
    for column in range(2):
        columns[0, column], columns[1, column], columns[2, column] = upper[0, column], upper[1, column], lower[column]
    for column in range(2):
        shared = 0.0
        if column == 1:
            for row in range(3):
                shared += columns[row, 0] * columns[row, 1]
        length = 0.0
        for row in range(3):
            if column == 1:
                columns[row, 1] -= shared * columns[row, 0]
            length += columns[row, column] ** 2
        for row in range(3):
            columns[row, column] /= np.sqrt(length)
    columns[0, 2] = columns[1, 0] * columns[2, 1] - columns[2, 0] * columns[1, 1]
    columns[1, 2] = columns[2, 0] * columns[0, 1] - columns[0, 0] * columns[2, 1]
    columns[2, 2] = columns[0, 0] * columns[1, 1] - columns[1, 0] * columns[0, 1]
    for row in range(3):
        for column in range(3):
            rotation[row, column] = (
                turn[row, 0] * columns[0, column]
                + turn[row, 1] * columns[1, column]
                + turn[row, 2] * columns[2, column]
            )


@compiled("void(float64, float64, float64[:, ::1], float64[:, :, ::1])")
def _rotations_of_jacobian(x: float, y: float, jacobian: Array, rotations: Array) -> None:
    """Both rotations, (2, 3, 3), written, that give the homography's Jacobian at an image point (IPPE, section 4.2)."""
    turn, a = np.empty((3, 3)), np.empty((2, 2))
    _turn_to_ray(x, y, turn)
    # The upper left of the turn, foreshortened, takes the unknown columns to the Jacobian.
    f00, f01 = turn[0, 0] - x * turn[2, 0], turn[0, 1] - x * turn[2, 1]
    f10, f11 = turn[1, 0] - y * turn[2, 0], turn[1, 1] - y * turn[2, 1]
    determinant = f00 * f11 - f01 * f10
    for column in range(2):
        a[0, column] = (f11 * jacobian[0, column] - f01 * jacobian[1, column]) / determinant
        a[1, column] = (f00 * jacobian[1, column] - f10 * jacobian[0, column]) / determinant
    norm = a[0, 0] ** 2 + a[0, 1] ** 2 + a[1, 0] ** 2 + a[1, 1] ** 2
    area = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    a /= np.sqrt(0.5 * (norm + np.sqrt(max(norm * norm - 4.0 * area * area, 0.0))))  # by the inverse depth
    # What the upper rows lack to unit columns is b b^T; one view leaves the sign of b open.
    lower = np.empty(2)
    lower[0] = np.sqrt(max(1.0 - a[0, 0] ** 2 - a[1, 0] ** 2, 0.0))
    lower[1] = np.sqrt(max(1.0 - a[0, 1] ** 2 - a[1, 1] ** 2, 0.0))
    if -(a[0, 0] * a[0, 1] + a[1, 0] * a[1, 1]) < 0.0:
        lower[1] = -lower[1]
    _write_rotation(turn, a, lower, rotations[0])
    _write_rotation(turn, a, -lower, rotations[1])


@compiled("void(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1], float64[::1])")
def _fit_translation(rotation: Array, plane: Array, image: Array, weights: Array, translation: Array) -> None:
    """Least-squares translation, shape (3,), written, of dots already turned: the rays must meet the dots."""
    normals = np.zeros((3, 3))
    translation[:] = 0.0
    for point in range(len(weights)):
        w, x, y = weights[point], image[point, 0], image[point, 1]
        p, q = plane[point]
        depth = rotation[2, 0] * p + rotation[2, 1] * q
        miss_x = x * depth - (rotation[0, 0] * p + rotation[0, 1] * q)
        miss_y = y * depth - (rotation[1, 0] * p + rotation[1, 1] * q)
        normals[0, 0] += w
        normals[1, 1] += w
        normals[2, 0] -= w * x
        normals[2, 1] -= w * y
        normals[2, 2] += w * (x * x + y * y)
        translation[0] += w * miss_x
        translation[1] += w * miss_y
        translation[2] -= w * (x * miss_x + y * miss_y)
    solve_symmetric(normals, translation)


@compiled("void(float64[:, ::1], float64[:, ::1], float64[::1], float64[:, :, ::1], float64[:, ::1])")
def solve_planar_pose(plane: Array, image: Array, weights: Array, rotations: Array, translations_m: Array) -> None:
    """Both poses ``cam_from_target`` of a target: rotations (2, 3, 3) and translations (2, 3), written.

    Parameters
    ----------
    plane, image : ndarray of shape (N, 2)
        Dots in the target's plane (m) and their image-plane coordinates.
    weights : ndarray of shape (N,)
        1 for a measured dot, 0 for another; the measured dots are not collinear.
    """
    h, jacobian = np.empty(ELEMENTS), np.empty((2, 2))
    _fit_homography(plane, image, weights, h)
    _, _, plane_size = _middle_and_spread(plane, weights)
    image_x, image_y, image_size = _middle_and_spread(image, weights)
    for column in range(2):
        jacobian[0, column] = (h[column] - h[2] * h[6 + column]) * image_size / plane_size
        jacobian[1, column] = (h[3 + column] - h[5] * h[6 + column]) * image_size / plane_size
    _rotations_of_jacobian(image_x + image_size * h[2], image_y + image_size * h[5], jacobian, rotations)
    for solution in range(2):
        _fit_translation(rotations[solution], plane, image, weights, translations_m[solution])
