"""Drawings as shapes: what SVG and PDF both can show, without either.

Coordinates are points (1/72 inch) from the top left corner, x to the right, y down.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# What a colour stands for; each format has its own colours for them. Series are told apart by people who see fewer
# colours; sizes go from small to large, ever farther from the paper's lightness, so that grey print keeps their order.
Series = Literal["series1", "series2", "series3", "series4", "series5", "series6"]
Size = Literal["size1", "size2", "size3", "size4", "size5"]
Ink = Literal["ink", "muted", "grid", "band", "target", "photo", "control", "check", "error"] | Series | Size
Anchor = Literal["start", "middle", "end"]


@dataclass(frozen=True)
class Pen:
    """How a shape is drawn: its colour, the width of its outline (0: none), whether it is filled, its dashes.

    ``dash`` holds lengths of strokes and gaps in turn, points; empty for a line without gaps.
    """

    ink: Ink
    width: float = 0.8
    filled: bool = False
    dash: tuple[float, ...] = ()


@dataclass(frozen=True)
class Path:
    """Straight lines through points of shape (N, 2)."""

    points: Array
    pen: Pen
    closed: bool = False

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or not np.isfinite(self.points).all():
            raise ValueError("a path takes finite points of two coordinates")


@dataclass(frozen=True)
class Ellipse:
    """An ellipse: centre (2,), semi-axes (2,), the first one turned clockwise from x by ``turn_deg``."""

    centre: Array
    semi_axes: Array
    turn_deg: float
    pen: Pen

    def __post_init__(self) -> None:
        if not np.isfinite([*self.centre, *self.semi_axes, self.turn_deg]).all():
            raise ValueError("an ellipse takes finite numbers")


@dataclass(frozen=True)
class Label:
    """A line of text beginning, centred or ending at a point (2,) of its baseline; ``upwards``: from below to above."""

    at: Array
    text: str
    ink: Ink = "ink"
    size: float = 8.0
    anchor: Anchor = "start"
    upwards: bool = False


Shape = Path | Ellipse | Label


@dataclass(frozen=True)
class Drawing:
    """Shapes on a sheet, the later ones above the earlier ones."""

    width: float
    height: float
    shapes: tuple[Shape, ...]


def line(start: Array, end: Array, pen: Pen) -> Path:
    """A straight line between two points (2,)."""
    return Path(np.array([start, end], dtype=np.float64), pen)


def rectangle(corner: Array, opposite: Array, pen: Pen) -> Path:
    """A rectangle between two opposite corners (2,)."""
    (left, top), (right, bottom) = corner, opposite
    return Path(np.array([[left, top], [right, top], [right, bottom], [left, bottom]]), pen, closed=True)


def arrow(start: Array, step: Array, pen: Pen, head: float = 3.0) -> tuple[Path, ...]:
    """An arrow from a point (2,) along a step (2,); its head is at most half as long as the arrow."""
    length = float(np.hypot(*step))
    if length == 0.0:
        return ()
    along = step / length
    across = np.array([-along[1], along[0]])
    reach = min(head, length / 2.0)
    tip = start + step
    neck = tip - reach * along
    point = Path(
        np.array([tip, neck + 0.4 * reach * across, neck - 0.4 * reach * across]), Pen(pen.ink, 0.0, True), True
    )
    return line(start, neck, pen), point
