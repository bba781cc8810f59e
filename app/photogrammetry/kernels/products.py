"""Products of the whitened collinearity equations of a target, and its own unknowns eliminated from them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.general import solve_general
from app.geometry.kernels.lens import linearise_projection
from app.photogrammetry.kernels.shared_errors import weigh_shared
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

OWN, INTRINSICS = 6, 9
COLUMNS = OWN + INTRINSICS + 1  # a target's own movement, the camera, and last the residual
FIELD_LIMIT = 3.0  # tangent of 72 degrees off the axis: beyond it Brown-Conrady describes no lens


@compiled("boolean(float64[:, ::1], float64[::1], float64[::1])")
def to_camera(rotation: Array, offset_m: Array, cam_m: Array) -> bool:
    """A point in the camera frame, written, by its offset from the camera in the site; whether it has an image."""
    for axis in range(3):
        cam_m[axis] = (
            rotation[0, axis] * offset_m[0] + rotation[1, axis] * offset_m[1] + rotation[2, axis] * offset_m[2]
        )
    return cam_m[2] > max(abs(cam_m[0]), abs(cam_m[1])) / FIELD_LIMIT


@compiled("void(float64[:, ::1], float64[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _fill_rows(rotation: Array, arm_m: Array, root: Array, by: Array, rows: Array) -> None:
    """Derivatives of a dot's image, two rows of 15, by its target's movement and the whitened intrinsics.

    A target's own movement ``translation + rotation x arm`` moves the image by ``d`` and ``arm x d``, where d is the
    image's derivative by the dot. ``by`` holds the derivatives by the point in the camera and by the intrinsics.
    """
    for row in range(2):
        line = rows[row]
        for axis in range(3):
            line[axis] = (
                rotation[axis, 0] * by[row, 0] + rotation[axis, 1] * by[row, 1] + rotation[axis, 2] * by[row, 2]
            )
        line[3] = arm_m[1] * line[2] - arm_m[2] * line[1]
        line[4] = arm_m[2] * line[0] - arm_m[0] * line[2]
        line[5] = arm_m[0] * line[1] - arm_m[1] * line[0]
        for column in range(INTRINSICS):
            line[OWN + column] = 0.0
        for inner in range(INTRINSICS):
            for column in range(INTRINSICS):
                line[OWN + column] += by[row, 3 + inner] * root[inner, column]


@compiled("void(float64[:, ::1], int64, float64[::1])")
def _whiten_pair(rows: Array, dot: int, whitener: Array) -> None:
    """Whiten the two rows of a dot in place."""
    above, below = rows[2 * dot], rows[2 * dot + 1]
    for column in range(COLUMNS):
        below[column] = whitener[1] * above[column] + whitener[2] * below[column]
        above[column] *= whitener[0]


@compiled("void(float64[:, ::1], float64[:, ::1])")
def _multiply(rows: Array, gram: Array) -> None:
    """Products of all columns of a target's rows, written."""
    gram[:] = 0.0
    for first in range(COLUMNS):
        products = gram[first]
        for row in range(0, 2 * DOT_COUNT, 4):  # four at a time: each sum is loaded and stored once for them
            a, b, c, d = rows[row, first], rows[row + 1, first], rows[row + 2, first], rows[row + 3, first]
            for second in range(COLUMNS):
                products[second] += (
                    a * rows[row, second]
                    + b * rows[row + 1, second]
                    + c * rows[row + 2, second]
                    + d * rows[row + 3, second]
                )


@compiled("void(float64[:, ::1], float64[::1])")
def _to_pose(reduced: Array, to_centre_m: Array) -> None:
    """Put the camera's movement, which is the target's the other way, in the place of the target's.

    Moving and turning the camera by (t, r) moves the target by ``centre x r - t`` and turns it by ``-r``.
    """
    x, y, z = to_centre_m
    for column in range(COLUMNS):
        a, b, c = reduced[0, column], reduced[1, column], reduced[2, column]
        reduced[0, column], reduced[1, column], reduced[2, column] = -a, -b, -c
        reduced[3, column] = z * b - y * c - reduced[3, column]
        reduced[4, column] = x * c - z * a - reduced[4, column]
        reduced[5, column] = y * a - x * b - reduced[5, column]
    for row in range(COLUMNS):
        a, b, c = reduced[row, 0], reduced[row, 1], reduced[row, 2]
        reduced[row, 0], reduced[row, 1], reduced[row, 2] = -a, -b, -c
        reduced[row, 3] = z * b - y * c - reduced[row, 3]
        reduced[row, 4] = x * c - z * a - reduced[row, 4]
        reduced[row, 5] = y * a - x * b - reduced[row, 5]


@compiled("void(float64[:, ::1], float64[:, ::1])")
def _to_gain(gram: Array, gain: Array) -> None:
    """A target's own covariance Q to (Q^-1 + N)^-1, in place, without inverting Q: it is zero for a perfect map."""
    mixed = np.eye(OWN)
    for row in range(OWN):
        for column in range(OWN):
            for inner in range(OWN):
                mixed[row, column] += gain[row, inner] * gram[inner, column]
    solve_general(mixed, gain)


@compiled("void(float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1])")
def _eliminate(gram: Array, own_covariance: Array, to_centre_m: Array, reduced: Array) -> None:
    """Products of pose, intrinsics and residual, written: the own unknowns out (Schur complement), the pose in."""
    gain = own_covariance.copy()
    _to_gain(gram, gain)
    gained = np.zeros((OWN, COLUMNS))
    for row in range(OWN):
        for inner in range(OWN):
            for column in range(COLUMNS):
                gained[row, column] += gain[row, inner] * gram[inner, column]
    for row in range(COLUMNS):
        for column in range(COLUMNS):
            reduced[row, column] = gram[row, column]
        for inner in range(OWN):
            for column in range(COLUMNS):
                reduced[row, column] -= gram[inner, row] * gained[inner, column]
    _to_pose(reduced, to_centre_m)


@compiled(
    "boolean(Tuple((float64[:, ::1], float64[::1], float64[::1], float64[:, ::1])), float64[::1], "
    "Tuple((float64[:, ::1], float64[:, ::1], float64[:, ::1], boolean[::1])), float64[:, ::1])"
)
def _fill_target(state: tuple[Array, ...], to_centre_m: Array, dots: tuple[Any, ...], rows: Array) -> bool:
    """Whitened rows (32, 16) of a target, written; whether all its dots have an image.

    ``dots`` holds a target's arms (16, 3), observed dots (16, 2), whiteners (16, 3) and which are measured (16,).
    """
    rotation, _, intrinsics, root = state
    arms_m, observed_px, whiteners, measured = dots
    offset_m, cam_m, imaged = np.empty(3), np.empty(3), True
    by_point, by_intrinsics, by = np.empty((2, 3)), np.empty((2, INTRINSICS)), np.empty((2, 3 + INTRINSICS))
    rows[:] = 0.0
    for dot in range(DOT_COUNT):
        if not measured[dot]:
            continue
        for axis in range(3):
            offset_m[axis] = to_centre_m[axis] + arms_m[dot, axis]
        if not to_camera(rotation, offset_m, cam_m):
            imaged = False
            cam_m[0], cam_m[1], cam_m[2] = 0.0, 0.0, 1.0  # has no image; its target is marked
        u, v = linearise_projection(intrinsics, cam_m, by_point, by_intrinsics)
        by[:, :3], by[:, 3:] = by_point, by_intrinsics
        pair = rows[2 * dot : 2 * dot + 2]
        _fill_rows(rotation, arms_m[dot], root, by, pair)
        pair[0, -1], pair[1, -1] = u - observed_px[dot, 0], v - observed_px[dot, 1]
        _whiten_pair(rows, dot, whiteners[dot])
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
        Products (K, 16, 16) of the whitened columns; the same with the own unknowns eliminated and the pose in their
        place (K, 16, 16); whether the target is seen from the front (K,).
    """
    rotations, centres_m, arms_m, own_covariances, observed_px, whiteners, measured, modes, sigmas = sighted
    gram, reduced, seen_from_front = equations
    to_centre_m, rows = np.empty(3), np.empty((2 * DOT_COUNT, COLUMNS))
    for target in range(len(centres_m)):
        facing = 0.0
        for axis in range(3):
            to_centre_m[axis] = centres_m[target, axis] - state[1][axis]
            facing += rotations[target, axis, 2] * to_centre_m[axis]
        dots = (arms_m[target], observed_px[target], whiteners[target], measured[target])
        imaged = _fill_target(state, to_centre_m, dots, rows)
        seen_from_front[target] = imaged and facing < 0.0
        _multiply(rows, gram[target])
        weigh_shared(rows, modes[target], sigmas[target], gram[target])
        _eliminate(gram[target], own_covariances[target], to_centre_m, reduced[target])
