"""Coefficients of fitted plates sorted into dots, background and what the fit leaves."""

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


@compiled("void(float32[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64, float64[:, ::1])")
def measure_power(samples: Array32, right: Array, solved: Array, ridge: float, rms: Array) -> None:
    """Root mean square of what a fit leaves, and of the samples about their means; shape (P, 2), written.

    Parameters
    ----------
    samples : ndarray of shape (P, 3, S), float32
    right, solved : ndarray of shape (P, 3, 54)
        Right-hand sides and solutions of the normal equations.
    ridge : float
        On the diagonal of the paper's coefficients.

    Notes
    -----
    With N x + R x = b the fit explains 2 b x - x N x = b x + x R x; no residual is formed.
    """
    plates, _, count = samples.shape
    for plate in range(plates):
        power, explained, steady = 0.0, 0.0, 0.0
        for channel in range(CHANNELS):
            line, b, x = samples[plate, channel], right[plate, channel], solved[plate, channel]
            squares = np.float32(0.0)
            for sample in range(count):
                squares += line[sample] * line[sample]
            power += float(squares)
            for coefficient in range(COEFFICIENTS):
                explained += b[coefficient] * x[coefficient]
            for coefficient in range(PAPER, COEFFICIENTS):
                explained += ridge * x[coefficient] * x[coefficient]
            # The background's constant column is 1 everywhere, so its product is the sum of the samples.
            steady += b[BACKGROUND] * b[BACKGROUND] / count
        rms[plate, 0] = np.sqrt(max(power - explained, 0.0) / (CHANNELS * count))
        rms[plate, 1] = np.sqrt(max(power - steady, 0.0) / (CHANNELS * count))


@compiled("void(float64[:, :, ::1], float64[:, :, ::1], float64[:, :, :, ::1])")
def sort_coefficients(solved: Array, amplitudes: Array, slopes: Array) -> None:
    """Solutions, shape (P, 3, 54), to amplitudes (P, 16, 3) and slopes (P, 16, 2, 3), written; channels last."""
    for plate in range(len(solved)):
        for channel in range(CHANNELS):
            line = solved[plate, channel]
            for dot in range(DOT_COUNT):
                amplitudes[plate, dot, channel] = line[PER_DOT * dot]
                slopes[plate, dot, 0, channel] = line[PER_DOT * dot + 1]
                slopes[plate, dot, 1, channel] = line[PER_DOT * dot + 2]
