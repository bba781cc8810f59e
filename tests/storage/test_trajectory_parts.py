from __future__ import annotations

import math

import pytest

from app.errors import InvalidInput
from app.storage.trajectory_parts import Box, TimeRange, TrajectoryFilter


def test_four_numbers_are_a_box_of_any_height() -> None:
    assert Box.of_numbers([1.0, 2.0, 3.0, 4.0]) == Box((1.0, 2.0, -math.inf), (3.0, 4.0, math.inf))
    assert Box.of_numbers([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]) == Box((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))


@pytest.mark.parametrize(
    "numbers", [[], [1.0], [1.0, 2.0, 3.0, 4.0, 5.0], [3.0, 0.0, 1.0, 1.0], [math.nan, 0.0, 1.0, 1.0]]
)
def test_what_is_no_box_is_refused(numbers: list[float]) -> None:
    with pytest.raises(InvalidInput, match="x_min,y_min,x_max,y_max"):
        Box.of_numbers(numbers)


@pytest.mark.parametrize("ends", [(2.0, 1.0), (1.0, 1.0)])
def test_a_range_without_a_time_in_it_is_refused(ends: tuple[float, float]) -> None:
    with pytest.raises(InvalidInput, match="from <= t < to"):
        TimeRange(*ends)


def test_a_box_is_meant_in_one_sites_frame() -> None:
    with pytest.raises(InvalidInput, match="site_id"):
        TrajectoryFilter(box=Box.of_numbers([0.0, 0.0, 1.0, 1.0]))
