from __future__ import annotations

import numpy as np

from app.services.reporting.drawing import Pen, arrow


def test_an_arrow_of_no_length_is_nothing_and_a_short_one_keeps_its_tip() -> None:
    pen = Pen("error")
    assert arrow(np.zeros(2), np.zeros(2), pen) == ()
    _, head = arrow(np.zeros(2), np.array([1.0, 0.0]), pen)
    np.testing.assert_allclose(head.points[0], [1.0, 0.0])
    assert head.points[:, 0].min() >= 0.5
