"""How long a length on the sheet is."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.services.reporting.drawing import Ink, Label, Pen, Shape, line

Array = npt.NDArray[np.float64]

KEY_SIZE = 7.0


def scale_bar(at: Array, length: float, text: str, ink: Ink) -> list[Shape]:
    """A length in points, and what it stands for."""
    pen, end, tick = Pen(ink, 1.1), at + np.array([length, 0.0]), np.array([0.0, 3.0])
    label = Label(end + np.array([6.0, 2.5]), text, ink, KEY_SIZE)
    return [line(at, end, pen), line(at - tick, at + tick, pen), line(end - tick, end + tick, pen), label]
