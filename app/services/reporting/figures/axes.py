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
TITLE_BELOW = 23.0  # from the frame to the baseline of the title of x, numbers between
ROOM_SHARE = 0.06  # free space around what a plan shows, as a share of its larger side
LEAST_SIDE_M = 1.0  # of a plan, for the room around it: places may all be one


@dataclass(frozen=True)
class Axes:
    """A frame on the sheet and the numbers at its corners.

    Attributes
    ----------
    low, high : ndarray of shape (2,)
        Numbers at the left bottom and the right top corner.
    corner, size : ndarray of shape (2,)
        The frame's left top corner and its width and height, points.
    written : float
        What numbers are multiplied with when they are written beside the frame.
    """

    low: Array
    high: Array
    corner: Array
    size: Array
    written: float = 1.0

    @property
    def points_per_unit(self) -> Array:
        """Points per number along x and y, shape (2,)."""
        return self.size / (self.high - self.low)

    def place(self, numbers: Array) -> Array:
        """Points on the sheet, shape (..., 2), of numbers of shape (..., 2); y grows upwards."""
        share = (numbers - self.low) / (self.high - self.low)
        return self.corner + np.stack([share[..., 0], 1.0 - share[..., 1]], axis=-1) * self.size

    def grid(self, axis: int, step: float, digits: int) -> list[Shape]:
        """Lines across one axis at multiples of a step, labelled with so many decimals."""
        shapes: list[Shape] = []
        for number in ticks(self.low[axis], self.high[axis], step):
            ends = np.array([self.low, self.high])
            ends[:, axis] = number
            start, end = self.place(ends)
            shapes.append(line(start, end, GRID))
            shapes.append(self._tick(axis, start, fixed(number * self.written, digits)))
        return shapes

    def titles(self, across: str, up: str, title_left: float) -> list[Shape]:
        """What is along x and along y; the latter's baseline so many points left of the frame."""
        left, top = self.corner
        below = np.array([left + self.size[0] / 2.0, top + self.size[1] + TITLE_BELOW])
        beside = np.array([left - title_left, top + self.size[1] / 2.0])
        return [
            Label(below, across, "ink", TICK_SIZE, "middle"),
            Label(beside, up, "ink", TICK_SIZE, "middle", upwards=True),
        ]

    def _tick(self, axis: int, start: Array, text: str) -> Label:
        if axis == 0:
            return Label(start + np.array([0.0, TICK_SIZE + TICK_GAP]), text, "muted", TICK_SIZE, "middle")
        return Label(start + np.array([-TICK_GAP, 0.35 * TICK_SIZE]), text, "muted", TICK_SIZE, "end")


def plan_axes(places_m: Array, corner: Array, free: Array) -> Axes:
    """A frame around places (N, 2) with one scale along both axes, in the middle of free points (2,) below a corner."""
    low, high = places_m.min(axis=0), places_m.max(axis=0)
    room = ROOM_SHARE * max(float((high - low).max()), LEAST_SIDE_M)
    low, high = low - room, high + room
    size = float((free / (high - low)).min()) * (high - low)
    return Axes(low, high, corner + np.array([(free[0] - size[0]) / 2.0, 0.0]), size)


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
