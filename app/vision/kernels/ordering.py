"""A handful of numbers put in order, without room for a copy."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]


@compiled("void(float64[::1])")
def sort_few(values: Array) -> None:
    """Ascending, in place; by insertion, which is the quickest for up to some thirty."""
    for place in range(1, len(values)):
        value, slot = values[place], place
        while slot > 0 and values[slot - 1] > value:
            values[slot] = values[slot - 1]
            slot -= 1
        values[slot] = value


@compiled("float64(float64[::1])")
def middle_of(values: Array) -> float:
    """The median of an odd number of values, which are put in order."""
    sort_few(values)
    return values[len(values) // 2]
