"""Residuals of dots, and chi-squares of targets' rigid movements."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.lens import project
from app.geometry.kernels.symmetric import solve_symmetric
from app.photogrammetry.kernels.layout import OWN
from app.photogrammetry.kernels.products import to_camera
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@compiled(
    "void(Tuple((float64[:, ::1], float64[::1], float64[::1])), Tuple((float64[:, ::1], float64[:, :, ::1], "
    "float64[:, :, ::1], boolean[:, ::1])), float64[:, :, ::1])"
)
def measure_residuals(state: tuple[Array, ...], sighted: tuple[Any, ...], residuals_px: Array) -> None:
    """Computed less observed dots, shape (K, 16, 2), written: zero where not measured, or where a dot has no image.

    Parameters
    ----------
    state : tuple of ndarray
        Rotation (3, 3) and position (3,) of the camera, intrinsics (9,).
    sighted : tuple of ndarray
        Centres (K, 3), arms (K, 16, 3), observed dots (K, 16, 2), which are measured (K, 16).
    """
    rotation, position_m, intrinsics = state
    centres_m, arms_m, observed_px, measured = sighted
    offset_m, cam_m = np.empty(3), np.empty(3)
    for target in range(len(centres_m)):
        for dot in range(DOT_COUNT):
            residuals_px[target, dot] = 0.0
            for axis in range(3):
                offset_m[axis] = centres_m[target, axis] + arms_m[target, dot, axis] - position_m[axis]
            if measured[target, dot] and to_camera(rotation, offset_m, cam_m):
                u, v = project(intrinsics, cam_m[0], cam_m[1], cam_m[2])
                residuals_px[target, dot, 0] = u - observed_px[target, dot, 0]
                residuals_px[target, dot, 1] = v - observed_px[target, dot, 1]


@compiled("void(float64[:, :, ::1], float64, float64[::1])")
def explain_by_movement(gram: Array, ridge: float, explained: Array) -> None:
    """The part of each target's squared residuals that a rigid movement of it explains, shape (K,), written.

    Parameters
    ----------
    gram : ndarray of shape (K, 16, 16)
        Products of the whitened columns: the movement's six come first, the residual last.
    ridge : float
        Few dots leave movements free; the ridge silences those (their right side is zero) and no other.
    """
    normals, right, scale = np.empty((OWN, OWN)), np.empty(OWN), np.empty(OWN)
    for target in range(len(gram)):
        products = gram[target]
        for row in range(OWN):
            scale[row] = np.sqrt(products[row, row]) if products[row, row] > 0.0 else 1.0
        for row in range(OWN):
            right[row] = products[row, -1] / scale[row]
            for column in range(row + 1):
                normals[row, column] = products[row, column] / (scale[row] * scale[column])
            normals[row, row] += ridge
        solve_symmetric(normals, right)
        explained[target] = 0.0
        for row in range(OWN):
            explained[target] += right[row] * products[row, -1] / scale[row]
