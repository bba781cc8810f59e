"""From the numbers of a figure to points on its sheet: one scale along both axes, or one each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.services.reporting.drawing import Label, Pen, Shape, line
from app.services.reporting.numbers import fixed, nice_below

Array = npt.NDArray[np.float64]

GRID = Pen("grid", 0.5)
TICK_SIZE = 7.0
TICK_GAP = 4.0


@dataclass(frozen=True)
class Axes:
    """A frame on the sheet and the numbers at its corners.

    Attributes
    ----------
    low, high : ndarray of shape (2,)
        Numbers at the left bottom and the right top corner.
    corner, size : ndarray of shape (2,)
        The frame's left top corner and its width and height, points.
    """

    low: Array
    high: Array
    corner: Array
    size: Array

    @property
    def points_per_unit(self) -> Array:
        """Points per number along x and y, shape (2,)."""
        return self.size / (self.high - self.low)

    def place(self, numbers: Array) -> Array:
        """Points on the sheet, shape (..., 2), of numbers of shape (..., 2); y grows upwards."""
        share = (numbers - self.low) / (self.high - self.low)
        return self.corner + np.stack([share[..., 0], 1.0 - share[..., 1]], axis=-1) * self.size

    def grid(self, axis: int, step: float, digits: int) -> list[Shape]:
        """Lines across one axis at multiples of a step, labelled."""
        shapes: list[Shape] = []
        for number in ticks(self.low[axis], self.high[axis], step):
            ends = np.array([self.low, self.high])
            ends[:, axis] = number
            start, end = self.place(ends)
            shapes.append(line(start, end, GRID))
            shapes.append(self._tick(axis, start, fixed(number, digits)))
        return shapes

    def _tick(self, axis: int, start: Array, text: str) -> Label:
        if axis == 0:
            return Label(start + np.array([0.0, TICK_SIZE + TICK_GAP]), text, "muted", TICK_SIZE, "middle")
        return Label(start + np.array([-TICK_GAP, 0.35 * TICK_SIZE]), text, "muted", TICK_SIZE, "end")


def ticks(low: float, high: float, step: float) -> list[float]:
    """Multiples of a step from ``low`` to ``high``."""
    first, last = int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9))
    return [step * number for number in range(first, last + 1)]


def nice_step(low: float, high: float, count: int) -> float:
    """A round step that parts a span in ``count`` or more."""
    return nice_below((high - low) / count)


def digits_of_step(step: float) -> int:
    """Decimals that tell multiples of a round step apart."""
    return max(0, -int(np.floor(np.log10(step) + 1e-9)))
