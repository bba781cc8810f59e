"""Equations of a pose whose dots are seen at different times."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.lens import linearise_projection
from app.photogrammetry.kernels.layout import INTRINSICS, OWN
from app.photogrammetry.kernels.products import fill_movement, to_camera

Array = npt.NDArray[np.float64]


@compiled(
    "void(Tuple((float64[:, ::1], float64[::1], float64[::1])), float64[:, ::1], float64[::1], "
    "Tuple((float64[:, ::1], float64[:, ::1])))"
)
def sum_lateness(state: tuple[Array, ...], dots_m: Array, times_s: Array, sums: tuple[Array, Array]) -> None:
    """Normal matrix (6, 6) of the scene's movement, and the same with each dot weighed by its time (6, 6), written.

    Parameters
    ----------
    state : tuple of ndarray
        Rotation (3, 3) and position (3,) of the camera, intrinsics (9,).
    dots_m : ndarray of shape (N, 3)
        Seen dots, site frame.
    times_s : ndarray of shape (N,)
        When each was seen.
    """
    rotation, position_m, intrinsics = state
    normals, late = sums
    normals[:], late[:] = 0.0, 0.0
    offset_m, cam_m, rows = np.empty(3), np.empty(3), np.empty((2, OWN))
    by_point, by_intrinsics = np.empty((2, 3)), np.empty((2, INTRINSICS))
    for dot in range(len(times_s)):
        for axis in range(3):
            offset_m[axis] = dots_m[dot, axis] - position_m[axis]
        to_camera(rotation, offset_m, cam_m)
        linearise_projection(intrinsics, cam_m, by_point, by_intrinsics)
        fill_movement(rotation, offset_m, by_point, rows)
        for first in range(OWN):
            for second in range(OWN):
                product = rows[0, first] * rows[0, second] + rows[1, first] * rows[1, second]
                normals[first, second] += product
                late[first, second] += times_s[dot] * product
