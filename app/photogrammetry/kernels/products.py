"""Products of the whitened collinearity equations of targets."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.lens import linearise_projection
from app.photogrammetry.kernels.elimination import eliminate_own
from app.photogrammetry.kernels.layout import COLUMNS, INTRINSICS, OWN
from app.photogrammetry.kernels.shared_errors import weigh_shared
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FIELD_LIMIT = 3.0  # tangent of 72 degrees off the axis: beyond it Brown-Conrady describes no lens


@compiled("boolean(float64[:, ::1], float64[::1], float64[::1])")
def to_camera(rotation: Array, offset_m: Array, cam_m: Array) -> bool:
    """A point in the camera frame, written, by its offset from the camera in the site; whether it has an image."""
    for axis in range(3):
        cam_m[axis] = (
            rotation[0, axis] * offset_m[0] + rotation[1, axis] * offset_m[1] + rotation[2, axis] * offset_m[2]
        )
    return cam_m[2] > max(abs(cam_m[0]), abs(cam_m[1])) / FIELD_LIMIT


@compiled("void(float64[::1], float64[:, :])")
def _whiten(whitener: Array, pair: Array) -> None:
    """Two rows of a dot in standard deviations, in place."""
    for column in range(pair.shape[1]):
        pair[1, column] = whitener[1] * pair[0, column] + whitener[2] * pair[1, column]
        pair[0, column] *= whitener[0]


@compiled("void(float64[:, ::1], float64[::1], float64[:, ::1], float64[:, ::1])")
def fill_movement(rotation: Array, arm_m: Array, by_point: Array, pair: Array) -> None:
    """Derivatives of a dot's image by its target's movement, the first six columns of two rows.

    The movement ``translation + rotation x arm`` moves the image by ``d`` and ``arm x d``, where d is the image's
    derivative by the dot; ``by_point`` is that by the point in the camera, (2, 3).
    """
    for row in range(2):
        line = pair[row]
        for axis in range(3):
            line[axis] = (
                rotation[axis, 0] * by_point[row, 0]
                + rotation[axis, 1] * by_point[row, 1]
                + rotation[axis, 2] * by_point[row, 2]
            )
        line[3] = arm_m[1] * line[2] - arm_m[2] * line[1]
        line[4] = arm_m[2] * line[0] - arm_m[0] * line[2]
        line[5] = arm_m[0] * line[1] - arm_m[1] * line[0]


@compiled("void(float64[:, ::1], float64[:, ::1])")
def _multiply(rows: Array, gram: Array) -> None:
    """Products of all columns of a target's rows, written."""
    gram[:] = 0.0
    for first in range(COLUMNS):
        products = gram[first]
        for row in range(0, 2 * DOT_COUNT, 4):  # four at a time: each sum is loaded and stored once for them
            a, b, c, d = rows[row, first], rows[row + 1, first], rows[row + 2, first], rows[row + 3, first]
            for second in range(first - first % 4, COLUMNS):  # whole registers
                products[second] += (
                    a * rows[row, second]
                    + b * rows[row + 1, second]
                    + c * rows[row + 2, second]
                    + d * rows[row + 3, second]
                )
        for second in range(first):
            products[second] = gram[second, first]


@compiled(
    "boolean(Tuple((float64[:, ::1], float64[::1], float64[::1], float64[:, ::1])), float64[::1], "
    "Tuple((float64[:, ::1], float64[:, ::1], float64[:, ::1], boolean[::1])), "
    "Tuple((float64[::1], float64[::1], float64[:, ::1], float64[:, ::1])), float64[:, ::1])"
)
def _fill_target(
    state: tuple[Array, ...], to_centre_m: Array, dots: tuple[Any, ...], room: tuple[Array, ...], rows: Array
) -> bool:
    """Whitened rows (32, 16) of a target, written; whether all its dots have an image.

    ``dots`` holds a target's arms (16, 3), observed dots (16, 2), whiteners (16, 3) and which are measured (16,);
    ``room`` is for an offset, a point, and derivatives by point (2, 3) and intrinsics (2, 9).
    """
    rotation, _, intrinsics, _ = state
    arms_m, observed_px, whiteners, measured = dots
    offset_m, cam_m, by_point, by_intrinsics = room
    imaged = True
    for dot in range(DOT_COUNT):
        pair = rows[2 * dot : 2 * dot + 2]
        if not measured[dot]:
            pair[:] = 0.0
            continue
        for axis in range(3):
            offset_m[axis] = to_centre_m[axis] + arms_m[dot, axis]
        if not to_camera(rotation, offset_m, cam_m):
            imaged = False
            cam_m[0], cam_m[1], cam_m[2] = 0.0, 0.0, 1.0  # has no image; its target is marked
        u, v = linearise_projection(intrinsics, cam_m, by_point, by_intrinsics)
        fill_movement(rotation, arms_m[dot], by_point, pair)
        pair[:, OWN : COLUMNS - 1] = by_intrinsics
        pair[0, -1], pair[1, -1] = u - observed_px[dot, 0], v - observed_px[dot, 1]
        _whiten(whiteners[dot], pair)
    return imaged


@compiled(
    "void(Tuple((float64[:, ::1], float64[::1], float64[::1], float64[:, ::1])), Tuple((float64[:, :, ::1], "
    "float64[:, ::1], float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], "
    "boolean[:, ::1], float64[:, :, ::1], float64[:, ::1])), Tuple((float64[:, :, ::1], "
    "float64[:, :, ::1], boolean[::1])))"
)
def linearise_targets(state: tuple[Array, ...], sighted: tuple[Any, ...], equations: tuple[Any, ...]) -> None:
    """The collinearity equations of K targets at a state.

    Parameters
    ----------
    state : tuple of ndarray
        Rotation (3, 3) and position (3,) of the camera, intrinsics (9,), root of their prior covariance (9, 9).
    sighted : tuple of ndarray
        The fields of ``SightedTargets`` from ``rotations`` on.
    equations : tuple of ndarray, written
        Products (K, 16, 16) of the columns: own movement, intrinsics, residual; the same with the own unknowns
        eliminated, the pose in their place and the camera in units of its prior (K, 16, 16); whether the target is seen
        from the front (K,).
    """
    rotations, centres_m, arms_m, own_covariances, observed_px, whiteners, measured, modes, sigmas = sighted
    gram, reduced, seen_from_front = equations
    to_centre_m, rows = np.empty(3), np.empty((2 * DOT_COUNT, COLUMNS))
    of_dot = (np.empty(3), np.empty(3), np.empty((2, 3)), np.empty((2, INTRINSICS)))
    of_target = (np.empty((OWN, OWN)), np.empty((OWN, OWN)), np.empty((INTRINSICS, COLUMNS)))
    for target in range(len(centres_m)):
        facing = 0.0
        for axis in range(3):
            to_centre_m[axis] = centres_m[target, axis] - state[1][axis]
            facing += rotations[target, axis, 2] * to_centre_m[axis]
        dots = (arms_m[target], observed_px[target], whiteners[target], measured[target])
        imaged = _fill_target(state, to_centre_m, dots, of_dot, rows)
        seen_from_front[target] = imaged and facing < 0.0
        _multiply(rows, gram[target])
        weigh_shared(rows, modes[target], sigmas[target], gram[target])
        changes = (own_covariances[target], to_centre_m, state[3])
        eliminate_own(gram[target], changes, of_target, reduced[target])
