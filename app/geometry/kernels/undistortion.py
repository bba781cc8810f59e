"""Image-plane coordinates of pixels, the lens' distortion taken off."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]


@compiled("void(float64[::1], float64[:, ::1], int64, float64[:, ::1])")
def normalise_points(intrinsics: Array, image_px: Array, steps: int, normalised: Array) -> None:
    """``(x / z, y / z)`` of pixels, shape (N, 2), written, by fixed-point steps of Brown-Conrady."""
    fx, fy, cx, cy, k1, k2, p1, p2, k3 = intrinsics
    for point in range(len(image_px)):
        xd, yd = (image_px[point, 0] - cx) / fx, (image_px[point, 1] - cy) / fy
        x, y = xd, yd
        for _ in range(steps):
            r2 = x * x + y * y
            radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
            next_x = (xd - 2.0 * p1 * x * y - p2 * (r2 + 2.0 * x * x)) / radial
            y = (yd - p1 * (r2 + 2.0 * y * y) - 2.0 * p2 * x * y) / radial
            x = next_x
        normalised[point, 0], normalised[point, 1] = x, y
