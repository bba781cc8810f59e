"""How large the errors are that the dots of one sighting share, beside those that each has by itself.

Blur, shading and the interpolation of colour move neighbouring dots together, so that sixteen dots are worth less than
sixteen independent ones. A sighting's errors are parted in three: the shift of the plate's image (2 numbers), its
linear deformation (4) and the rest.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

SHIFT, LINEAR = slice(0, 2), slice(2, 6)
MODE_COUNT = 6


@dataclass(frozen=True)
class PlateSigmas:
    """Standard deviations of the three parts, as multiples of what the dots' covariances say."""

    shift: float
    linear: float
    dots: float

    def __post_init__(self) -> None:
        if not min(astuple(self)) > 0:
            raise ValueError(f"standard deviations must be positive, got {astuple(self)}")

    @property
    def of_modes(self) -> Array:
        """Of the six modes, shape (6,): two of shift, four linear."""
        return np.array([self.shift] * 2 + [self.linear] * 4)


INDEPENDENT_DOTS = PlateSigmas(1.0, 1.0, 1.0)
