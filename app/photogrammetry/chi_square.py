"""Limits of chi-squares that are asked for again and again."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri

Array = npt.NDArray[np.float64]

MOST_FREEDOM = 6  # of a rigid movement


@cache
def limits_by_freedom(probability: float) -> Array:
    """What chance exceeds with a probability, by degrees of freedom from 0 (where it is NaN) to 6, shape (7,)."""
    limits = np.asarray(chdtri(np.arange(MOST_FREEDOM + 1), probability), dtype=np.float64)
    limits.flags.writeable = False
    return limits
