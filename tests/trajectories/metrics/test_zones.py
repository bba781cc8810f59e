from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.trajectories.metrics.errors import Errors
from app.trajectories.metrics.zones import ELSEWHERE, Zone, accuracy_by_zone

LSHAPE = Zone("l", np.array([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]], float))


@given(st.floats(-1, 5), st.floats(-1, 4))
def test_an_l_is_its_two_rectangles(x_m: float, y_m: float) -> None:
    rectangles = (0 < x_m < 4 and 0 < y_m < 1) or (0 < x_m < 1 and 0 < y_m < 3)
    on_an_edge = x_m in (0, 1, 4) or y_m in (0, 1, 3)
    assert on_an_edge or bool(LSHAPE.contains(np.array([[x_m, y_m]]))[0]) == rectangles


def test_neighbours_share_no_point_and_leave_none_out() -> None:
    left = Zone("left", np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float))
    right = Zone("right", np.array([[1, 0], [2, 0], [2, 1], [1, 1]], float))
    border = np.column_stack([np.ones(9), np.linspace(0.05, 0.95, 9)])
    assert (left.contains(border) ^ right.contains(border)).all()


def test_each_zone_has_its_own_accuracy_and_the_rest_too() -> None:
    positions_m = np.array([[0.5, 0.5, 1.0], [3.0, 0.5, 1.0], [3.0, 3.0, 1.0]])
    errors = Errors(np.arange(3.0), np.array([[1.0, 0, 0], [3.0, 0, 0], [7.0, 0, 0]]), None, None)
    far = Zone("far", np.array([[50, 50], [51, 50], [50, 51]], float))
    table = accuracy_by_zone(errors, positions_m, [LSHAPE, far])
    assert set(table) == {"l", ELSEWHERE}
    assert (table["l"].horizontal.mean, table[ELSEWHERE].horizontal.mean) == (2.0, 7.0)
    assert accuracy_by_zone(errors, positions_m, []) == {}


def test_two_corners_are_no_zone() -> None:
    with pytest.raises(ValueError, match="corners"):
        Zone("line", np.zeros((2, 2)))
