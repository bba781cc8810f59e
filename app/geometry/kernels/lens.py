"""Brown-Conrady's projection of one point, for other kernels; ``Camera`` holds the same for arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]


@compiled("UniTuple(float64, 2)(float64[::1], float64, float64, float64)")
def project(intrinsics: Array, x_m: float, y_m: float, z_m: float) -> tuple[float, float]:
    """Pixel of a point before the camera."""
    fx, fy, cx, cy, k1, k2, p1, p2, k3 = intrinsics
    x, y = x_m / z_m, y_m / z_m
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = fx * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + cx
    v = fy * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) + cy
    return u, v


@compiled("UniTuple(float64, 2)(float64[::1], float64[::1], float64[:, ::1], float64[:, ::1])")
def linearise_projection(intrinsics: Array, cam_m: Array, by_point: Array, by_intrinsics: Array) -> tuple[float, float]:
    """Pixel of a point before the camera, with its derivatives written: by the point (2, 3), by intrinsics (2, 9)."""
    fx, fy, cx, cy, k1, k2, p1, p2, k3 = intrinsics
    inverse_z = 1.0 / cam_m[2]
    x, y = cam_m[0] * inverse_z, cam_m[1] * inverse_z
    x2, y2, xy = x * x, y * y, x * y
    r2 = x2 + y2
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    radial_by_r2 = k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3)
    xd = x * radial + 2.0 * p1 * xy + p2 * (r2 + 2.0 * x2)
    yd = y * radial + p1 * (r2 + 2.0 * y2) + 2.0 * p2 * xy
    mixed = 2.0 * xy * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y
    xd_x, xd_y = fx * (radial + 2.0 * x2 * radial_by_r2 + 2.0 * p1 * y + 6.0 * p2 * x), fx * mixed
    yd_x, yd_y = fy * mixed, fy * (radial + 2.0 * y2 * radial_by_r2 + 6.0 * p1 * y + 2.0 * p2 * x)
    by_point[0, 0], by_point[0, 1], by_point[0, 2] = (
        xd_x * inverse_z,
        xd_y * inverse_z,
        -(xd_x * x + xd_y * y) * inverse_z,
    )
    by_point[1, 0], by_point[1, 1], by_point[1, 2] = (
        yd_x * inverse_z,
        yd_y * inverse_z,
        -(yd_x * x + yd_y * y) * inverse_z,
    )
    by_intrinsics[:] = 0.0
    by_intrinsics[0, 0], by_intrinsics[1, 1] = xd, yd
    by_intrinsics[0, 2], by_intrinsics[1, 3] = 1.0, 1.0
    by_intrinsics[0, 4], by_intrinsics[1, 4] = fx * x * r2, fy * y * r2
    by_intrinsics[0, 5], by_intrinsics[1, 5] = fx * x * r2 * r2, fy * y * r2 * r2
    by_intrinsics[0, 6], by_intrinsics[1, 6] = fx * 2.0 * xy, fy * (r2 + 2.0 * y2)
    by_intrinsics[0, 7], by_intrinsics[1, 7] = fx * (r2 + 2.0 * x2), fy * 2.0 * xy
    by_intrinsics[0, 8], by_intrinsics[1, 8] = fx * x * r2 * r2 * r2, fy * y * r2 * r2 * r2
    return xd * fx + cx, yd * fy + cy
