"""When the parts of a picture were exposed, however the picture was turned."""

from __future__ import annotations

import numpy as np
import pytest

from app.geometry.readout import Readout

WIDTH_PX, HEIGHT_PX = 400, 300


def test_the_middle_is_exposed_at_zero_and_the_rows_after_each_other() -> None:
    readout = Readout(0.03)
    rows_px = np.array([[0.0, 0.0], [7.0, 149.5], [0.0, 299.0]])
    times_s = readout.times_s(rows_px, WIDTH_PX, HEIGHT_PX)
    assert times_s == pytest.approx([-0.03 * 149.5 / 300, 0.0, 0.03 * 149.5 / 300])


@pytest.mark.parametrize("quarter_turns", [1, 2, 3, 4])
def test_a_turned_picture_was_exposed_when_it_was_exposed(quarter_turns: int) -> None:
    readout = Readout(0.02)
    point_px, width_px, height_px = np.array([31.0, 57.0]), WIDTH_PX, HEIGHT_PX
    time_s = readout.times_s(point_px, width_px, height_px)
    for _ in range(quarter_turns):  # clockwise: new x = height - 1 - y, new y = x
        point_px = np.array([height_px - 1 - point_px[1], point_px[0]])
        width_px, height_px = height_px, width_px
    assert readout.turned(quarter_turns).times_s(point_px, width_px, height_px) == pytest.approx(time_s)


@pytest.mark.parametrize("duration_s", [-0.01, np.nan, np.inf])
def test_a_readout_takes_a_time(duration_s: float) -> None:
    with pytest.raises(ValueError, match="readout"):
        Readout(duration_s)
