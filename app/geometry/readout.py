"""When the parts of a picture were exposed: a rolling shutter reads one row after the other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Direction = Literal["down", "left", "up", "right"]

TURNED_CLOCKWISE: dict[Direction, Direction] = {"down": "left", "left": "up", "up": "right", "right": "down"}
AXES: dict[Direction, tuple[int, float]] = {"down": (1, 1.0), "up": (1, -1.0), "right": (0, 1.0), "left": (0, -1.0)}


@dataclass(frozen=True)
class Readout:
    """How a sensor is read.

    Attributes
    ----------
    duration_s : float
        From the first to the last row; 10 to 35 ms in phones.
    direction : str
        Where in the picture the reading goes: ``down`` as the sensor lies, another way once the picture was turned.
    """

    duration_s: float
    direction: Direction = "down"

    def __post_init__(self) -> None:
        if not 0.0 <= self.duration_s < np.inf:
            raise ValueError(f"a readout takes a time, not negative and finite, got {self.duration_s} s")

    def times_s(self, image_px: Array, width_px: int, height_px: int) -> Array:
        """Exposure of image points, shape (..., 2), relative to the middle of the picture, shape (...)."""
        axis, sign = AXES[self.direction]
        size_px = (width_px, height_px)[axis]
        return np.asarray(sign * self.duration_s * (image_px[..., axis] - (size_px - 1) / 2.0) / size_px)

    def turned(self, quarter_turns: int) -> Readout:
        """The same reading in a picture turned clockwise by quarter turns."""
        direction = self.direction
        for _ in range(quarter_turns % 4):
            direction = TURNED_CLOCKWISE[direction]
        return replace(self, direction=direction)
