from __future__ import annotations

import numpy as np
import pytest

from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step, ticks


def test_axes_grow_to_the_right_and_up() -> None:
    axes = Axes(np.array([-1.0, 0.0]), np.array([1.0, 10.0]), np.array([5.0, 6.0]), np.array([100.0, 50.0]))
    np.testing.assert_allclose(axes.place(np.array([[-1.0, 0.0], [1.0, 10.0]])), [[5.0, 56.0], [105.0, 6.0]])


def test_ticks_are_multiples_within_the_span() -> None:
    assert ticks(-0.4, 0.4, 0.2) == pytest.approx([-0.4, -0.2, 0.0, 0.2, 0.4])
    assert nice_step(0.0, 10.0, 5) == pytest.approx(2.0)
    assert [digits_of_step(step) for step in (20.0, 1.0, 0.5, 0.02)] == [0, 0, 1, 2]
