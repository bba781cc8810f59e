"""Labels that can be read: none covers another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.services.reporting.drawing import Label

Array = npt.NDArray[np.float64]

LETTER_WIDTH = 0.58  # of the size; digits and small letters of a sans serif
LETTER_HEIGHT = 0.75  # of a digit
BEFORE = {"start": 0.0, "middle": 0.5, "end": 1.0}


def legible(labels: Sequence[Label]) -> list[Label]:
    """The labels without those that would cover an earlier one."""
    kept: list[Label] = []
    boxes = np.empty((len(labels), 4))
    for label in labels:
        left, top, right, bottom = box = _box(label)
        others = boxes[: len(kept)]
        apart = (others[:, 0] > right) | (others[:, 2] < left) | (others[:, 1] > bottom) | (others[:, 3] < top)
        if apart.all():
            boxes[len(kept)] = box
            kept.append(label)
    return kept


def _box(label: Label) -> Array:
    """Left, top, right, bottom on the sheet."""
    width = LETTER_WIDTH * label.size * len(label.text)
    x, y = label.at
    left = x - BEFORE[label.anchor] * width
    return np.array([left, y - LETTER_HEIGHT * label.size, left + width, y])
