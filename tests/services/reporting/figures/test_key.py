from __future__ import annotations

import numpy as np

from app.services.reporting.drawing import Label, Path, Pen
from app.services.reporting.figures.key import LINE_HEIGHT, key, key_height


def test_a_key_breaks_into_lines_that_fit() -> None:
    entries = [
        (Pen("series1"), "a system with a long name"),
        (Pen("series2", dash=(2.0, 1.0)), "another"),
        (Pen("size1"), "third"),
    ]
    shapes = key(np.array([10.0, 20.0]), 180.0, entries)
    names = {shape.text: shape.at for shape in shapes if isinstance(shape, Label)}
    assert [float(at[1] - 20.0) / LINE_HEIGHT for at in names.values()] == [0.0, 1.0, 1.0]
    assert key_height(180.0, entries) == 2 * LINE_HEIGHT
    assert [shape.pen for shape in shapes if isinstance(shape, Path)] == [pen for pen, _ in entries]


def test_a_filled_sample_is_a_box() -> None:
    (box, _) = key(np.zeros(2), 100.0, [(Pen("band", 0.0, filled=True), "uncertainty")])
    assert isinstance(box, Path) and box.closed and len(box.points) == 4
