"""Light and pixel values: the sRGB curve both ways, and the phone's contrast on top of it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]

# IEC 61966-2-1: below the knee the curve is a line.
SRGB_KNEE_LINEAR, SRGB_KNEE_ENCODED = 0.0031308, 0.04045
SRGB_SLOPE, SRGB_GAMMA, SRGB_OFFSET = 12.92, 2.4, 0.055

MAX_8_BIT = 255
TABLE_STEPS = 2**14  # of linear light: where the curve is steepest, a step is a fifth of an 8-bit level


def linear_of_srgb(rgb: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Linear light, 0 ... 1, of 8-bit sRGB values of any shape."""
    encoded = np.asarray(rgb, dtype=np.float64) / MAX_8_BIT
    curve = ((encoded + SRGB_OFFSET) / (1.0 + SRGB_OFFSET)) ** SRGB_GAMMA
    return np.where(encoded <= SRGB_KNEE_ENCODED, encoded / SRGB_SLOPE, curve)


def srgb_of_linear(linear: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """SRGB values, 0 ... 1, of linear light of any shape; light beyond white is clipped."""
    light = np.clip(np.asarray(linear, dtype=np.float64), 0.0, 1.0)
    curve = (1.0 + SRGB_OFFSET) * light ** (1.0 / SRGB_GAMMA) - SRGB_OFFSET
    return np.where(light <= SRGB_KNEE_LINEAR, light * SRGB_SLOPE, curve)


def develop(linear: Floats, contrast: float) -> npt.NDArray[np.uint8]:
    """8-bit values of linear light: sRGB, blended with the S-curve 3 v^2 - 2 v^3 by ``contrast`` (0 ... 1).

    Parameters
    ----------
    linear : ndarray of any shape
        1 is what saturates a pixel.
    contrast : float
        0 gives plain sRGB; phones lie about 0.2 ... 0.4.
    """
    encoded = srgb_of_linear(np.linspace(0.0, 1.0, TABLE_STEPS + 1))
    curve = (1.0 - contrast) * encoded + contrast * encoded**2 * (3.0 - 2.0 * encoded)
    table = np.rint(curve * MAX_8_BIT).astype(np.uint8)
    steps = np.clip(linear, 0.0, 1.0) * np.float32(TABLE_STEPS) + np.float32(0.5)
    return table[steps.astype(np.int32)]
