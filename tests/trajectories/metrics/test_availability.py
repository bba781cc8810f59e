from __future__ import annotations

import numpy as np

from app.trajectories.metrics.availability import availability, latency


def test_the_covered_share_and_the_longest_silence() -> None:
    found = availability(np.arange(0.0, 10.0), np.array([-5.0, 0.4, 1.0, 2.0, 7.5]), max_gap_s=0.5)
    assert found.covered_share == 0.5  # 0, 1, 2, 7 and 8
    assert found.longest_silence_s == 5.5


def test_a_system_that_never_spoke_covers_nothing() -> None:
    silent = availability(np.array([0.0, 4.0]), np.zeros(0), max_gap_s=1.0)
    assert (silent.covered_share, silent.longest_silence_s) == (0.0, 4.0)


def test_latency_is_arrival_less_moment() -> None:
    assert latency(np.array([1.0, 2.0]), np.array([1.25, 2.75])).mean == 0.5
