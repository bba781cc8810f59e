from __future__ import annotations

import numpy as np
import pytest

from app.errors import InvalidInput
from app.trajectories.clock_filter import ClockComparison, choose_comparison


def test_the_true_offset_lies_within_the_half_delay_of_the_best_comparison() -> None:
    random, true_offset_s = np.random.default_rng(5), 3.2
    comparisons = []
    for asked_s in np.arange(0.0, 20.0):
        there_s, back_s = random.exponential(0.05, 2) + 0.002
        comparisons.append(ClockComparison(asked_s, asked_s + there_s + back_s, asked_s + there_s + true_offset_s))
    best = choose_comparison(comparisons)
    assert abs(best.offset_s - true_offset_s) <= best.half_delay_s
    assert best.half_delay_s == min(comparison.half_delay_s for comparison in comparisons)


def test_no_comparison_or_an_impossible_one_is_refused() -> None:
    with pytest.raises(InvalidInput, match="GET /time"):
        choose_comparison([])
    with pytest.raises(InvalidInput, match="clock was set"):
        choose_comparison([ClockComparison(2.0, 1.0, 1.5)])
