from __future__ import annotations

import numpy as np

from app.trajectories.metrics.availability import availability, availability_of, latency
from app.trajectories.trajectory import Trajectory


def test_the_covered_share_and_the_longest_silence() -> None:
    found = availability(np.arange(0.0, 10.0), np.array([-5.0, 0.4, 1.0, 2.0, 7.5]), max_gap_s=0.5)
    assert found.covered_share == 0.5  # 0, 1, 2, 7 and 8
    assert found.longest_silence_s == 5.5


def test_a_system_that_never_spoke_covers_nothing() -> None:
    silent = availability(np.array([0.0, 4.0]), np.zeros(0), max_gap_s=1.0)
    assert (silent.covered_share, silent.longest_silence_s) == (0.0, 4.0)


def test_latency_is_arrival_less_moment() -> None:
    assert latency(np.array([1.0, 2.0]), np.array([1.25, 2.75])).mean == 0.5


def test_latency_is_told_where_arrivals_are_whatever_the_clocks_offset() -> None:
    times_s = np.arange(4.0)
    said = Trajectory(times_s, np.zeros((4, 3)), arrived_s=times_s + np.array([0.1, 0.2, 0.3, 0.8]))
    for trajectory in (said, said.shifted(1000.0)):
        found = availability_of(trajectory.times_s, trajectory, 1.0).latency_s
        assert found is not None
        np.testing.assert_allclose([found.mean, found.median, found.greatest], [0.35, 0.25, 0.8])
    assert availability_of(times_s, Trajectory(times_s, np.zeros((4, 3))), 1.0).latency_s is None
    assert availability_of(times_s, Trajectory.empty(), 1.0).latency_s is None
