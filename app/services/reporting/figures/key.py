"""A key: strokes and the names of what they stand for, in lines as wide as the sheet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.services.reporting.drawing import Label, Pen, Shape, line, rectangle
from app.services.reporting.figures.labels import LETTER_WIDTH
from app.services.reporting.figures.scale_bar import KEY_SIZE

Array = npt.NDArray[np.float64]

SAMPLE = 20.0  # length of a stroke
SAMPLE_GAP, ENTRY_GAP = 5.0, 14.0
LINE_HEIGHT = 12.0
RISE = 2.5  # a stroke stands above the baseline of its name
HALF_BOX = 3.0  # of a filled sample


def key(at: Array, width: float, entries: Sequence[tuple[Pen, str]]) -> list[Shape]:
    """Samples with their names, the first one's baseline at a point (2,)."""
    shapes: list[Shape] = []
    for (column, row), (pen, text) in zip(_places(width, entries), entries, strict=True):
        start = at + np.array([column, row * LINE_HEIGHT])
        shapes.append(_sample(start - np.array([0.0, RISE]), pen))
        shapes.append(Label(start + np.array([SAMPLE + SAMPLE_GAP, 0.0]), text, "ink", KEY_SIZE))
    return shapes


def key_height(width: float, entries: Sequence[tuple[Pen, str]]) -> float:
    """How high the key will be."""
    return LINE_HEIGHT * (1 + max(row for _, row in _places(width, entries)))


def _places(width: float, entries: Sequence[tuple[Pen, str]]) -> list[tuple[float, int]]:
    """Left end and line of each entry."""
    places: list[tuple[float, int]] = []
    column, row = 0.0, 0
    for _, text in entries:
        needed = SAMPLE + SAMPLE_GAP + LETTER_WIDTH * KEY_SIZE * len(text)
        if column > 0.0 and column + needed > width:
            column, row = 0.0, row + 1
        places.append((column, row))
        column += needed + ENTRY_GAP
    return places


def _sample(start: Array, pen: Pen) -> Shape:
    end = start + np.array([SAMPLE, 0.0])
    if pen.filled:
        half = np.array([0.0, HALF_BOX])
        return rectangle(start - half, end + half, pen)
    return line(start, end, pen)
