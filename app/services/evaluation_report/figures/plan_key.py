"""The plan's key: what colours stand for and how long lengths are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import get_args

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.units import length_unit
from app.services.reporting.drawing import Pen, Shape, Size
from app.services.reporting.figures.axes import digits_of_step
from app.services.reporting.figures.key import key, key_height
from app.services.reporting.figures.scale_bar import scale_bar
from app.services.reporting.numbers import fixed, nice_below

Array = npt.NDArray[np.float64]

SIZES: tuple[Size, ...] = get_args(Size)
THINNEST, THICKER = 0.7, 0.15  # width of the smallest class, and what each further one adds
BAR = 90.0  # points at most
BARS_APART = 220.0
BARS_HEIGHT = 18.0


@dataclass(frozen=True)
class ClassScale:
    """How the errors are drawn: limits between the classes, enlargement, the plan's points per metre."""

    limits_m: Array
    enlargement: float
    points_per_m: float

    @staticmethod
    def pen(index: int) -> Pen:
        """The stroke of a class."""
        return Pen(SIZES[index], THINNEST + THICKER * index)

    @property
    def entries(self) -> list[tuple[Pen, str]]:
        """Classes and their names."""
        unit = length_unit(float(self.limits_m[-1]))
        digits = digits_of_step(float(self.limits_m[0]) * unit.per_base)
        told = [fixed(limit * unit.per_base, digits) for limit in self.limits_m.tolist()]
        names = [
            f"up to {told[0]} {unit.name}",
            *(f"to {limit}" for limit in told[1:]),
            f"above {told[-1]} {unit.name}",
        ]
        return [(self.pen(index), name) for index, name in enumerate(names)]


def plan_key(at: Array, width: float, scale: ClassScale) -> list[Shape]:
    """Scale bars, and the classes below them."""
    below = at + np.array([0.0, BARS_HEIGHT])
    return [*_bars(at, scale), *key(below, width, scale.entries)]


def plan_key_height(width: float, scale: ClassScale) -> float:
    """From the baseline of the bars to the lower edge."""
    return BARS_HEIGHT + key_height(width, scale.entries)


def _bars(at: Array, scale: ClassScale) -> list[Shape]:
    """A length of the plan; one of errors where these are enlarged."""
    plan_m = nice_below(BAR / scale.points_per_m)
    both = "in the plan and of errors" if scale.enlargement == 1.0 else "in the plan"
    shapes = scale_bar(at, plan_m * scale.points_per_m, f"{_length(plan_m)} {both}", "ink")
    if scale.enlargement > 1.0:
        per_m = scale.enlargement * scale.points_per_m
        error_m = nice_below(BAR / per_m)
        shapes += scale_bar(at + np.array([BARS_APART, 0.0]), error_m * per_m, f"{_length(error_m)} of errors", "ink")
    return shapes


def _length(value_m: float) -> str:
    """A round length and its unit."""
    unit = length_unit(value_m)
    return f"{value_m * unit.per_base:g} {unit.name}"
