"""Where each point of an image looks: the lens model inverted once on a coarse grid and splined in between."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.interpolate import RectBivariateSpline

from app.geometry.camera import Camera

Floats = npt.NDArray[np.float64]

# A cubic spline errs by h^4 f'''' / 384: with a phone's distortion an 80th of the focal length leaves below 1e-5 px.
NODES_PER_FOCAL_LENGTH = 80.0
CUBIC_NODES = 4  # at least
MARGIN_PX = 1.0  # samples inside the outermost pixels reach half a pixel beyond their centres


class RayGrid:
    """Image-plane coordinates (x / z, y / z) of any grid of image points of a camera."""

    def __init__(self, camera: Camera) -> None:
        self.camera = camera
        step_px = camera.fx_px / NODES_PER_FOCAL_LENGTH
        columns_px, rows_px = _nodes(camera.width_px, step_px), _nodes(camera.height_px, step_px)
        normalised = camera.normalise(np.stack(np.meshgrid(columns_px, rows_px), axis=-1))
        self._x = RectBivariateSpline(rows_px, columns_px, normalised[..., 0])
        self._y = RectBivariateSpline(rows_px, columns_px, normalised[..., 1])
        flat = normalised.reshape(-1, 2)
        self.least, self.greatest = flat.min(axis=0), flat.max(axis=0)

    def at(self, columns_px: Floats, rows_px: Floats) -> tuple[Floats, Floats]:
        """X / z and y / z, each of shape (R, C), at ascending rows (R,) and columns (C,)."""
        return self._x(rows_px, columns_px), self._y(rows_px, columns_px)


def _nodes(size_px: int, step_px: float) -> Floats:
    first_px, last_px = -MARGIN_PX, size_px - 1 + MARGIN_PX
    count = max(CUBIC_NODES, int(np.ceil((last_px - first_px) / step_px)) + 1)
    return np.linspace(first_px, last_px, count)
