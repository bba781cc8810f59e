"""Dots that a person marked in a photograph, where no detector saw them or saw them wrongly."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
import numpy.typing as npt

from app.targets.layout import DOT_COUNT

# What people reach with a loupe of eight times on a clear dot; a detector reaches a tenth of it.
HAND_SIGMA_PX = 0.5


@dataclass(frozen=True)
class Mark:
    """One dot's centre.

    Attributes
    ----------
    code : int
        The target's.
    cell : int
        Row-major, 0 ... 15.
    position_px : ndarray of shape (2,)
        In the photograph as the sensor's rows lie.
    sigma_px : float
        Standard deviation of each coordinate.
    """

    code: int
    cell: int
    position_px: npt.NDArray[np.float64]
    sigma_px: float = HAND_SIGMA_PX

    def __post_init__(self) -> None:
        if not 0 <= self.cell < DOT_COUNT:
            raise ValueError(f"a plate has the cells 0 ... {DOT_COUNT - 1}, not {self.cell}")
        if self.position_px.shape != (2,) or not np.isfinite(self.position_px).all():
            raise ValueError("a mark stands at two finite pixel coordinates")
        if not (isfinite(self.sigma_px) and self.sigma_px > 0):
            raise ValueError(f"a mark's sigma must be positive, got {self.sigma_px}")
