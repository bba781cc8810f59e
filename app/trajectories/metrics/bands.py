"""How many errors are how large, axis by axis: the paper's Table 3."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.trajectories.metrics.errors import Errors

ROUNDING_DIGITS = 9  # differences of decimal numbers: 0.3 - 0.2 is not above 0.1


def counts_in_bands(errors: Errors, limits_m: Sequence[float]) -> npt.NDArray[np.int64]:
    """Pairs by the size of their error along x, y and z, shape (3, bands).

    Parameters
    ----------
    errors : Errors
    limits_m : sequence of float
        Increasing. The first band is below the first limit, the last above the last; a limit belongs to the band that
        lies between it and its neighbour, as in the paper, or above it when there is but one.
    """
    sizes_m = np.round(np.abs(errors.vectors_m), ROUNDING_DIGITS)
    if len(limits_m) == 0 or (np.diff(limits_m) <= 0).any():
        raise ValueError(f"limits increase and there is one at least, got {list(limits_m)}")
    inner = np.array(limits_m)
    inner[1:] = np.nextafter(inner[1:], np.inf)  # an upper limit belongs below, the lowest above
    band = np.searchsorted(inner, sizes_m, side="right")
    return np.array([np.bincount(band[:, axis], minlength=len(limits_m) + 1) for axis in range(3)])
