"""How noisy a dot's edge is in linear light, by its ink: a step of grey values is more light at white than at black.

Noise is much the same at all grey values, and the template fit knows but one noise for a whole plate.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.vision.centres import YCC_FROM_BGR, DotCentres
from app.vision.kernels.coefficients import CHANNELS
from app.vision.measurement import PlateFits

Array = npt.NDArray[np.float64]

# sRGB (IEC 61966-2-1): light is the 2.4th power of the grey value, so its derivative goes with light^(1.4 / 2.4).
SQUARED_SLOPE_EXPONENT = 2.0 * 1.4 / 2.4
LIGHT_RANGE = (1.0, 255.0)  # below, the curve is a line


def weigh_by_ink(fits: PlateFits, dots: DotCentres) -> DotCentres:
    """The dots with variances that follow their inks' noise, about the one that the plate's fit has found."""
    factors = noise_factors(fits)
    counts = np.maximum(dots.measured.sum(axis=1, keepdims=True), 1)
    mean = (factors * dots.measured).sum(axis=1, keepdims=True) / counts
    factors = factors / np.where(mean > 0.0, mean, 1.0)
    return replace(dots, covariances_u2=dots.covariances_u2 * factors[..., None, None])


def noise_factors(fits: PlateFits) -> Array:
    """Noise variance of the luma and chromas that place a dot, shape (P, 16), in any unit.

    Half-way up the dot's edge, where it is placed, by the share that luma and each chroma have in its place
    (``kernels.places``).
    """
    half_way = np.clip(fits.background[:, None] + fits.amplitudes / 2.0, *LIGHT_RANGE)
    # Powers in single precision run on vector registers.
    by_channel = half_way.reshape(-1, CHANNELS).astype(np.float32) ** np.float32(SQUARED_SLOPE_EXPONENT)
    by_row = by_channel @ (YCC_FROM_BGR**2).T
    shares = (fits.amplitudes.reshape(-1, CHANNELS) @ YCC_FROM_BGR.T) ** 2
    result: Array = np.einsum("dr,dr->d", shares, by_row) / np.maximum(np.einsum("dr->d", shares), 1.0)
    return result.reshape(fits.amplitudes.shape[:2])
