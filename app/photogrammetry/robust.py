"""Robust losses per dot: what a residual costs and how much of its weight it keeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# 0.6745 sigma bounds half of a normal distribution in one dimension; in two, half lie within sqrt(2 ln 2) sigma.
MEDIAN_LENGTH_2D = float(np.sqrt(2.0 * np.log(2.0)))


@dataclass(frozen=True)
class RobustLoss:
    """A loss of the length of a dot's residual (two coordinates), in standard deviations.

    Attributes
    ----------
    kind : str
        ``huber``: linear beyond the width, for clean observations; ``cauchy``: forgets what is far off, for dirty ones.
    width : float
        Where the loss leaves the square, in standard deviations.
    """

    kind: Literal["huber", "cauchy"]
    width: float

    def cost(self, squared: Array) -> Array:
        """Twice the negative log-likelihood of squared lengths, same shape; the square itself when small."""
        w2 = self.width**2
        if self.kind == "cauchy":
            return np.asarray(w2 * np.log1p(squared / w2))
        return np.where(squared <= w2, squared, 2.0 * self.width * np.sqrt(squared) - w2)

    def weight(self, squared: Array) -> Array:
        """Factor of a dot's information, derivative of the cost, same shape."""
        if self.kind == "cauchy":
            return np.asarray(1.0 / (1.0 + squared / self.width**2))
        return np.asarray(self.width / np.sqrt(np.maximum(squared, self.width**2)))

    def widened(self, factor: float) -> RobustLoss:
        """The same loss for residuals that are larger by a factor."""
        return RobustLoss(self.kind, self.width * factor)


def robust_scale(squared: Array) -> float:
    """Standard deviation of one coordinate, from the median of squared lengths of any shape (N > 0)."""
    return float(np.sqrt(np.median(squared)) / MEDIAN_LENGTH_2D)
