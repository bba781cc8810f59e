from __future__ import annotations

import numpy as np
import pytest

from app.trajectories.metrics.bootstrap import (
    BootstrapOptions,
    correlation_length,
    interval_of,
    paired_difference,
)
from app.trajectories.trajectory import Array

FEW = BootstrapOptions(resamples=400)


def mean(values: Array) -> Array:
    return values.mean(axis=-1)


def chain(count: int, memory: float, seed: int) -> Array:
    """Errors that remember: x_k = memory x_(k-1) + noise, of variance 1."""
    random = np.random.default_rng(seed)
    values = np.empty(count)
    values[0] = random.normal()
    for row in range(1, count):
        values[row] = memory * values[row - 1] + np.sqrt(1 - memory**2) * random.normal()
    return values


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_intervals_hold_the_truth_about_as_often_as_they_say(memory: float) -> None:
    """Of 120 intervals of 95 % that hold the truth independently, 108 or more do so in 99 % of all cases.

    The block bootstrap of a few hundred correlated errors is known to hold it somewhat less often: 100 are asked for.
    """
    held = 0
    for seed in range(120):
        interval = interval_of(chain(400, memory, seed), mean, FEW)
        held += interval.low <= 0.0 <= interval.high
    assert held >= (100 if memory else 108)


def test_resampling_single_errors_would_be_too_sure_of_correlated_ones() -> None:
    values = chain(400, 0.8, 1)
    blocks, singles = interval_of(values, mean, FEW), interval_of(values, mean, BootstrapOptions(400, block=1))
    assert blocks.block > 5
    assert blocks.high - blocks.low > 1.5 * (singles.high - singles.low)


def test_the_same_seed_gives_the_same_interval() -> None:
    values = chain(100, 0.5, 2)
    assert interval_of(values, mean, FEW) == interval_of(values, mean, FEW)
    assert interval_of(values, mean, FEW) != interval_of(values, mean, BootstrapOptions(400, seed=2))


def test_white_noise_needs_no_blocks_and_constants_none_either() -> None:
    assert correlation_length(np.random.default_rng(3).normal(size=1000)) <= 2
    assert correlation_length(np.ones(50)) == 1
    assert correlation_length(np.array([1.0])) == 1
    constant = interval_of(np.full(20, 3.0), mean, FEW)
    assert (constant.low, constant.value, constant.high) == (3.0, 3.0, 3.0)


def test_pairing_shows_a_difference_that_the_spread_of_each_would_hide() -> None:
    hard = np.abs(chain(300, 0.0, 4))
    difference = paired_difference(hard + 0.05, hard, FEW)
    assert difference.low > 0.049
    assert paired_difference(hard, hard, FEW).low == 0.0
