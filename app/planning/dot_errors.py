"""What the detector will say of a dot's centre before there is a picture: its covariance by size, slant and light.

A dot is placed by its rim. Each piece of rim tells its own distance along its normal, so that the information on the
centre is the sum of ``n n^T ds`` over the rim, times what the light gives; dots little larger than the blur give less.
``python -m benchmarks.dot_errors`` compares this with what the detector says in rendered rooms.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.plate_sigmas import PlateSigmas
from app.targets.layout import DOT_RADIUS_U
from app.vision.reading import ReadingOptions

Array = npt.NDArray[np.float64]
Light = Literal["bright", "indoor", "dim"]

LIGHTS: tuple[Light, ...] = ("bright", "indoor", "dim")
RIM_PIECES = 32  # of a dot's rim: the sum is exact to 1e-3 up to incidences of 75 degrees
MINOR_SHARE = 1e-3  # of a dot's greater semi-axis: a plate seen from its edge has no less


@dataclass(frozen=True)
class DotErrorOptions:
    """How well rims are seen.

    Attributes
    ----------
    bright, indoor, dim : float
        Standard deviation, px, of a dot whose rim is a circle of 1 px without any blur: a phone's full well of 5,000
        electrons by day, of 1,000 in a lit room, of 300 and a stop under in a dim one.
    blur_px : float
        Semi-axis at which blur takes half of the information: the share is ``1 / (1 + (blur_px / semi-axis)^4)``.
    plate_sigmas : PlateSigmas
        What the dots of a plate share, as the detector says.
    """

    bright: float = 0.057
    indoor: float = 0.069
    dim: float = 0.155
    blur_px: float = 2.0
    plate_sigmas: PlateSigmas = ReadingOptions().plate_sigmas

    def of_rim(self, light: Light) -> float:
        """Standard deviation of a circle of 1 px in some light."""
        return {"bright": self.bright, "indoor": self.indoor, "dim": self.dim}[light]


def dot_information(px_by_u: Array, light: Light, options: DotErrorOptions = DotErrorOptions()) -> Array:
    """Inverse covariance of dots' centres, shape (..., 2, 2), 1 / px^2.

    Parameters
    ----------
    px_by_u : ndarray of shape (..., 2, 2)
        Derivative of pixels by plate coordinates at the dot.
    light : str
    options : DotErrorOptions, optional
    """
    angle = (np.arange(RIM_PIECES) + 0.5) * 2.0 * np.pi / RIM_PIECES
    forward = DOT_RADIUS_U * np.column_stack([-np.sin(angle), np.cos(angle)])
    along = forward @ np.swapaxes(px_by_u, -1, -2)  # d rim / d angle
    normal = np.stack([along[..., 1], -along[..., 0]], axis=-1)  # as long as ds / d angle
    length = np.linalg.norm(along, axis=-1, keepdims=True)
    rim = np.swapaxes(normal / length, -1, -2) @ normal * (2.0 / RIM_PIECES)
    share = 1.0 / (1.0 + (options.blur_px / _lesser_axis_px(px_by_u)) ** 4)
    return np.asarray(rim * (share / options.of_rim(light) ** 2)[..., None, None])


def _lesser_axis_px(px_by_u: Array) -> Array:
    """Lesser semi-axis of a dot's image, shape (...,)."""
    squares = (px_by_u**2).sum(axis=(-1, -2))
    determinant = px_by_u[..., 0, 0] * px_by_u[..., 1, 1] - px_by_u[..., 0, 1] * px_by_u[..., 1, 0]
    greater = np.sqrt((squares + np.sqrt(np.maximum(squares**2 - 4.0 * determinant**2, 0.0))) / 2.0)
    return DOT_RADIUS_U * np.maximum(np.abs(determinant) / greater, MINOR_SHARE * greater)
