"""The plan's key: symbols and what they stand for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.services.reporting.drawing import Ellipse, Ink, Label, Path, Pen, Shape, arrow, line
from app.services.reporting.figures.scale_bar import KEY_SIZE

Array = npt.NDArray[np.float64]

SYMBOL = 4.0
WEDGE = np.array([[0.0, 0.0], [9.0, -4.0], [9.0, 4.0]])  # the angle of view, its tip at the projection centre
ENTRIES: Sequence[tuple[Ink, str, float]] = (
    ("target", "target (plate)", 90.0),
    ("photo", "photograph", 82.0),
    ("control", "control point", 86.0),
    ("check", "check point", 80.0),
    ("error", "residual", 60.0),
)


def symbol(place: Array, ink: Ink) -> tuple[Shape, ...]:
    """A triangle for a control point, a circle for a check point."""
    if ink == "control":
        corners = SYMBOL * np.array([[0.0, -1.2], [1.0, 0.6], [-1.0, 0.6]])
        return (Path(place + corners, Pen(ink, 1.1), closed=True),)
    return (Ellipse(place, np.full(2, 0.85 * SYMBOL), 0.0, Pen(ink, 1.1)),)


def legend(at: Array) -> list[Shape]:
    """What the symbols stand for."""
    shapes: list[Shape] = []
    for ink, text, width in ENTRIES:
        middle = at + np.array([6.0, -2.5])
        shapes.extend(_sample(ink, middle))
        shapes.append(Label(at + np.array([16.0, 0.0]), text, "ink", KEY_SIZE))
        at = at + np.array([width, 0.0])
    return shapes


def _sample(ink: Ink, middle: Array) -> tuple[Shape, ...]:
    reach = np.array([6.0, 0.0])
    if ink == "target":
        return (line(middle - reach, middle + reach, Pen(ink, 1.4)),)
    if ink == "photo":
        return (Path(middle - reach / 2 + WEDGE * 0.8, Pen(ink, 0.7), closed=True),)
    if ink == "error":
        return arrow(middle - reach, 2 * reach, Pen(ink, 0.9))
    return symbol(middle, ink)
