"""How sure a statistic of errors is: resampled in blocks, since errors that follow each other are alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.trajectories.trajectory import Array

Statistic = Callable[[Array], Array]  # of values of shape (..., K) over the last axis


@dataclass(frozen=True)
class BootstrapOptions:
    """How often, how wide, how reproducible.

    Attributes
    ----------
    resamples : int
        Enough for the ends of a 95 % interval to move by a hundredth of its width from seed to seed; of many errors,
        whose interval is narrow anyhow, fewer are drawn.
    confidence : float
        Share of the interval.
    block : int or None
        Errors that stay together; None: the least block that leaves the blocks' means uncorrelated, estimated from the
        errors' own autocorrelation.
    seed : int
    """

    resamples: int = 2000
    confidence: float = 0.95
    block: int | None = None
    seed: int = 1


@dataclass(frozen=True)
class Interval:
    """A statistic with its confidence interval.

    Attributes
    ----------
    value, low, high : float
    block : int
        Errors that were kept together.
    """

    value: float
    low: float
    high: float
    block: int


GREATEST_CHUNK = 4_000_000  # numbers drawn at a time: 32 MB
GREATEST_DRAW = 40_000_000  # numbers drawn for one interval: some seconds
LEAST_RESAMPLES = 200  # with these, the ends move by a tenth of the interval's width
CORRELATED = 1.96  # autocorrelations below this over sqrt(K) are those of white noise (two-sided 95 %)


def interval_of(values: Array, statistic: Statistic, options: BootstrapOptions | None = None) -> Interval:
    """Confidence interval of a statistic of one or more values, shape (K,).

    Parameters
    ----------
    values : ndarray of shape (K,)
        In the order of time.
    statistic : callable
        Takes values of shape (M, K) to M numbers.
    options : BootstrapOptions, optional

    Notes
    -----
    Circular block bootstrap (Politis and Romano, in Exploring the Limits of Bootstrap, 1992), percentile interval.
    """
    options = options or BootstrapOptions()
    block = options.block or correlation_length(values)
    drawn = _drawn(values, statistic, block, options)
    tail = (1.0 - options.confidence) / 2.0
    low, high = np.quantile(drawn, [tail, 1.0 - tail]).tolist()
    return Interval(float(statistic(values[None])[0]), low, high, block)


def _drawn(values: Array, statistic: Statistic, block: int, options: BootstrapOptions) -> Array:
    random, count = np.random.default_rng(options.seed), len(values)
    blocks = -(-count // block)
    at_a_time = max(1, GREATEST_CHUNK // count)
    wanted = min(options.resamples, max(LEAST_RESAMPLES, GREATEST_DRAW // count))
    drawn = []
    for first in range(0, wanted, at_a_time):
        resamples = min(at_a_time, wanted - first)
        starts = random.integers(count, size=(resamples, blocks, 1))
        rows = (starts + np.arange(block)).reshape(resamples, -1)[:, :count] % count
        drawn.append(statistic(values[rows]))
    return np.concatenate(drawn)


def correlation_length(values: Array) -> int:
    """How many errors in a row are alike: the first lag whose autocorrelation is that of noise, doubled.

    Notes
    -----
    The lag is the rule of Politis and White (Econometric Reviews 23(1), 2004) for their flat-top window, whose width is
    twice the lag after which nothing is left.
    """
    count = len(values)
    centred = values - values.mean()
    variance = float(centred @ centred)
    if count < 3 or variance == 0.0:
        return 1
    padded = 1 << (2 * count - 1).bit_length()
    spectrum = np.fft.rfft(centred, padded)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2, padded)[: count // 2 + 1] / variance
    alike = np.abs(correlation) > CORRELATED / np.sqrt(count)
    lag = int(np.argmin(alike)) if not alike.all() else len(correlation) - 1
    return max(1, min(2 * (lag - 1), count // 2)) if lag > 1 else 1


def paired_difference(first: Array, second: Array, options: BootstrapOptions | None = None) -> Interval:
    """Mean of ``first - second``, the errors of two systems at the same moments, with its interval.

    An interval without 0 says that one is better than the other.
    """
    return interval_of(first - second, lambda values: values.mean(axis=-1), options)
