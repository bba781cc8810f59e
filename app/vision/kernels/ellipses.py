"""Blobs as ellipses, from their moments."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]

PIXEL_VARIANCE_PX2 = 1.0 / 12.0  # of a pixel's own square


@compiled("int64(float64[:, ::1], UniTuple(float64, 3), float64[:, ::1], float64[:, ::1])")
def fit_ellipses(moments: Array, bounds: tuple[float, float, float], centres_px: Array, semi_axes_px: Array) -> int:
    """Centres and semi-axes, shape (N, 2), written one behind the other, of blobs that may be dots; their number.

    Parameters
    ----------
    moments : ndarray of shape (N, 6)
        As ``label_blobs`` gives them.
    bounds : tuple of float
        Of ``DotOptions`` both of area_px2, and axis_ratio_max.
    """
    least, most, axis_ratio_max = bounds
    kept = 0
    for blob in range(len(moments)):
        count = moments[blob, 0]
        if not least <= count <= most:
            continue
        x, y = moments[blob, 1] / count, moments[blob, 2] / count
        xx, yy = moments[blob, 3] / count - x * x, moments[blob, 4] / count - y * y
        xy = moments[blob, 5] / count - x * y
        mean, spread = 0.5 * (xx + yy) + PIXEL_VARIANCE_PX2, np.hypot(0.5 * (xx - yy), xy)
        # A filled ellipse has a variance of a quarter of its squared semi-axis.
        major, minor = 2.0 * np.sqrt(mean + spread), 2.0 * np.sqrt(mean - spread)
        if major <= axis_ratio_max * minor:
            centres_px[kept, 0], centres_px[kept, 1] = x, y
            semi_axes_px[kept, 0], semi_axes_px[kept, 1] = major, minor
            kept += 1
    return kept
