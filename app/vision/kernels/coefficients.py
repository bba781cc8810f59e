"""A plate's coefficients, from the right-hand sides of its normal equations, and what they leave unexplained."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]

# Coefficients: per dot the disc and its derivatives, then background (constant, x, y), then paper (constant, x, y).
PER_DOT, CHANNELS = 3, 3
BACKGROUND = PER_DOT * DOT_COUNT
PAPER = BACKGROUND + 3
COEFFICIENTS = PAPER + 3


@compiled("void(float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def solve_plate(right: Array, cofactors: Array, solved: Array) -> None:
    """``right @ cofactors``, cofactors being symmetric."""
    blue, green, red = right[0], right[1], right[2]
    for coefficient in range(COEFFICIENTS):
        line = cofactors[coefficient]
        by_blue, by_green, by_red = 0.0, 0.0, 0.0
        for other in range(COEFFICIENTS):
            by_blue += blue[other] * line[other]
            by_green += green[other] * line[other]
            by_red += red[other] * line[other]
        solved[0, coefficient], solved[1, coefficient], solved[2, coefficient] = by_blue, by_green, by_red


@compiled("UniTuple(float64, 2)(float32[:, ::1], float64[:, ::1], float64[:, ::1], UniTuple(float64, 2), int64)")
def unexplained_in_sight(
    samples: Array32, right: Array, solved: Array, ridges: tuple[float, float], count: int
) -> tuple[float, float]:
    """Root mean square of what a fit leaves, and of the samples about their means.

    Parameters
    ----------
    samples : ndarray of shape (3, S), float32
        0 where a sample is out of sight.
    right, solved : ndarray of shape (3, 54)
        Right-hand sides and solutions of the normal equations.
    ridges : tuple of float
        On the diagonal of all but the paper's coefficients, and of these.
    count : int
        Samples in sight.

    Notes
    -----
    With N x + R x = b the fit explains 2 b x - x N x = b x + x R x; no residual is formed.
    """
    power, explained, steady = 0.0, 0.0, 0.0
    for channel in range(CHANNELS):
        line, b, x = samples[channel], right[channel], solved[channel]
        squares = np.float32(0.0)
        for sample in range(samples.shape[1]):
            squares += line[sample] * line[sample]
        power += float(squares)
        for coefficient in range(COEFFICIENTS):
            ridge = ridges[1] if coefficient >= PAPER else ridges[0]
            explained += (b[coefficient] + ridge * x[coefficient]) * x[coefficient]
        # The background's constant column is 1 everywhere, so its product is the sum of the samples.
        steady += b[BACKGROUND] * b[BACKGROUND] / count
    all_samples = CHANNELS * count
    return np.sqrt(max(power - explained, 0.0) / all_samples), np.sqrt(max(power - steady, 0.0) / all_samples)


@compiled("UniTuple(float64, 2)(float32[:, ::1], float64[:, ::1], float64[:, ::1], float64)")
def unexplained(samples: Array32, right: Array, solved: Array, ridge: float) -> tuple[float, float]:
    """The same of plates that are all in sight, with a ridge on the paper's coefficients alone."""
    return unexplained_in_sight(samples, right, solved, (0.0, ridge), samples.shape[1])


@compiled("void(float64[:, ::1], float64, float64[:, ::1], float64[:, :, ::1], float64[:, ::1])")
def sort_coefficients(solved: Array, reach_u: float, amplitudes: Array, slopes: Array, planes: Array) -> None:
    """A solution, shape (3, 54), to amplitudes (16, 3), slopes (16, 2, 3), channels last, and planes (3, 6), per u."""
    for channel in range(CHANNELS):
        line = solved[channel]
        for dot in range(DOT_COUNT):
            amplitudes[dot, channel] = line[PER_DOT * dot]
            slopes[dot, 0, channel] = line[PER_DOT * dot + 1]
            slopes[dot, 1, channel] = line[PER_DOT * dot + 2]
        for place in range(COEFFICIENTS - BACKGROUND):
            steady = place % 3 == 0  # the first of a plane's three; the others are per reach
            planes[channel, place] = line[BACKGROUND + place] if steady else line[BACKGROUND + place] / reach_u
