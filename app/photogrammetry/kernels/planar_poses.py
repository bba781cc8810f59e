"""Both poses of flat targets: closed form, then least squared reprojection error by Levenberg and Marquardt."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.rotation import turn_rotation
from app.geometry.kernels.symmetric import solve_symmetric
from app.photogrammetry.kernels.planar import solve_planar_pose

Array = npt.NDArray[np.float64]

POSE, SOLUTIONS = 6, 2
DOTS = "Tuple((float64[:, ::1], float64[:, ::1], float64[::1]))"  # in the plane (N, 2), in the image (N, 2), weights
REFINEMENT = "Tuple((int64, float64, float64, float64, float64))"


@compiled("UniTuple(float64, 2)(float64[:, ::1], float64[::1])")
def _extents(points: Array, weights: Array) -> tuple[float, float]:
    """Extents across and along the best line of weighted points (N, 2): roots of their moments' eigenvalues."""
    total, x, y = 0.0, 0.0, 0.0
    for point in range(len(weights)):
        total += weights[point]
        x += weights[point] * points[point, 0]
        y += weights[point] * points[point, 1]
    x, y, xx, xy, yy = x / total, y / total, 0.0, 0.0, 0.0
    for point in range(len(weights)):
        across, along = points[point, 0] - x, points[point, 1] - y
        xx += weights[point] * across * across
        xy += weights[point] * across * along
        yy += weights[point] * along * along
    middle, half = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    return np.sqrt(max(middle - half, 0.0)), np.sqrt(max(middle + half, 0.0))


@compiled(f"boolean({DOTS}, float64, float64)")
def _fix_a_pose(dots: tuple[Array, ...], min_dots: float, min_spread: float) -> bool:
    """Whether there are enough measured dots, off one line and not all in one image point."""
    plane, image, weights = dots
    if weights.sum() < min_dots:
        return False
    least, greatest = _extents(plane, weights)
    return least > min_spread * greatest and _extents(image, weights)[1] > 0.0


@compiled(f"float64(float64[:, ::1], float64[::1], {DOTS})")
def _squared_error(rotation: Array, translation_m: Array, dots: tuple[Array, ...]) -> float:
    """Weighted squared reprojection error; infinite when a measured dot is not in front."""
    plane, image, weights = dots
    squared = 0.0
    for dot in range(len(weights)):
        if weights[dot] == 0.0:
            continue
        p, q = plane[dot]
        depth_m = rotation[2, 0] * p + rotation[2, 1] * q + translation_m[2]
        if depth_m <= 0.0:
            return np.inf
        x = (rotation[0, 0] * p + rotation[0, 1] * q + translation_m[0]) / depth_m - image[dot, 0]
        y = (rotation[1, 0] * p + rotation[1, 1] * q + translation_m[1]) / depth_m - image[dot, 1]
        squared += weights[dot] * (x * x + y * y)
    return squared


@compiled(f"void(float64[:, ::1], float64[::1], {DOTS}, float64[:, ::1], float64[::1])")
def _sum_equations(
    rotation: Array, translation_m: Array, dots: tuple[Array, ...], normals: Array, gradient: Array
) -> None:
    """Normal equations by translation and small rotation from the left, written: a lower triangle (6, 6), and (6,)."""
    plane, image, weights = dots
    normals[:], gradient[:] = 0.0, 0.0
    row = np.empty(POSE)
    for dot in range(len(weights)):
        p, q = plane[dot]
        qx, qy = rotation[0, 0] * p + rotation[0, 1] * q, rotation[1, 0] * p + rotation[1, 1] * q
        qz = rotation[2, 0] * p + rotation[2, 1] * q
        depth_m = qz + translation_m[2]
        if weights[dot] == 0.0 or depth_m <= 0.0:
            continue
        x, y = (qx + translation_m[0]) / depth_m, (qy + translation_m[1]) / depth_m
        for axis in range(2):
            if axis == 0:
                row[0], row[1], row[2], row[3], row[4], row[5] = 1.0, 0.0, -x, -x * qy, qz + x * qx, -qy
                residual = x - image[dot, 0]
            else:
                row[0], row[1], row[2], row[3], row[4], row[5] = 0.0, 1.0, -y, -qz - y * qy, y * qx, qx
                residual = y - image[dot, 1]
            for first in range(POSE):
                gradient[first] += weights[dot] * row[first] / depth_m * residual
                for second in range(first + 1):
                    normals[first, second] += weights[dot] * row[first] * row[second] / (depth_m * depth_m)


@compiled(f"float64(float64[:, ::1], float64[::1], {DOTS}, {REFINEMENT})")
def _refine(rotation: Array, translation_m: Array, dots: tuple[Array, ...], options: tuple[Any, ...]) -> float:
    """Refine a pose in place; its squared error."""
    steps, damping, damping_factor, converged, floor = options
    normals, gradient, step = np.empty((POSE, POSE)), np.empty(POSE), np.empty(POSE)
    turned, moved_m = np.empty((3, 3)), np.empty(3)
    squared = _squared_error(rotation, translation_m, dots)
    for _ in range(steps):
        _sum_equations(rotation, translation_m, dots, normals, gradient)
        for unknown in range(POSE):
            normals[unknown, unknown] *= 1.0 + damping
            step[unknown] = -gradient[unknown]
        solve_symmetric(normals, step)
        turn_rotation(rotation, step[3:], turned)
        gain = 0.0
        for axis in range(3):
            moved_m[axis] = translation_m[axis] + step[axis]
        for unknown in range(POSE):
            gain -= gradient[unknown] * step[unknown]
        trial = _squared_error(turned, moved_m, dots)
        damping *= 1.0 / damping_factor if trial < squared else damping_factor
        if trial < squared:
            rotation[:], translation_m[:], squared = turned, moved_m, trial
        if np.isfinite(squared) and gain <= converged * squared + floor * floor:
            break
    return squared


@compiled(
    f"void(Tuple((float64[:, :, ::1], float64[:, :, ::1], float64[:, ::1])), UniTuple(float64, 2), {REFINEMENT}, "
    "Tuple((float64[:, :, :, ::1], float64[:, :, ::1], float64[:, ::1])))"
)
def pose_targets(
    dots: tuple[Array, ...], least: tuple[float, float], refinement: tuple[Any, ...], poses: tuple[Array, ...]
) -> None:
    """Both poses of K targets, the better first.

    Parameters
    ----------
    dots : tuple of ndarray
        In the plane (K, N, 2), m; in the image plane (K, N, 2); weights (K, N), 1 for a measured dot, 0 for another.
    least : tuple of float
        Fewest dots, and least ratio of their extents, that give a pose.
    refinement : tuple
        Most steps, then the other options of refining as ``PlanarPoseOptions`` has them.
    poses : tuple of ndarray, written
        Rotations (K, 2, 3, 3) and translations (K, 2, 3) ``cam_from_target``, root mean square errors (K, 2). A target
        without a pose is left as it is.
    """
    rotations, translations_m, rms = poses
    for target in range(len(rms)):
        seen = (dots[0][target], dots[1][target], dots[2][target])
        if not _fix_a_pose(seen, least[0], least[1]):
            continue
        solve_planar_pose(seen[0], seen[1], seen[2], rotations[target], translations_m[target])
        for solution in range(SOLUTIONS):
            squared = _refine(rotations[target, solution], translations_m[target, solution], seen, refinement)
            rms[target, solution] = np.sqrt(squared / (2.0 * seen[2].sum()))
        if rms[target, 1] < rms[target, 0]:
            rotations[target] = rotations[target, ::-1].copy()
            translations_m[target] = translations_m[target, ::-1].copy()
            rms[target] = rms[target, ::-1].copy()
