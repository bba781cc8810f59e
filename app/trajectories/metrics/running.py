"""The error so far, pair by pair as pairs come."""

from __future__ import annotations

import math
from bisect import insort
from dataclasses import dataclass

import numpy as np

from app.trajectories.metrics.summary import CIRCULAR
from app.trajectories.trajectory import Array


@dataclass(frozen=True)
class ErrorSoFar:
    """What all pairs until now amount to, metres.

    Attributes
    ----------
    count : int
    mean_m, rmse_m : float
        Of the distance in space.
    ce50_m, ce95_m : float
        Quantiles (type 7) of the distance in the plan.
    """

    count: int
    mean_m: float
    rmse_m: float
    ce50_m: float
    ce95_m: float


class RunningErrors:
    """Sums, and the distances in the plan in order: a pair more costs no look at the others."""

    def __init__(self) -> None:
        self._horizontal_m: list[float] = []
        self._sum_m = 0.0
        self._sum_of_squares_m2 = 0.0

    @classmethod
    def of(cls, horizontal_m: Array, spatial_m: Array) -> tuple[RunningErrors, ErrorSoFar]:
        """Some pairs at once, one at least, of shape (K,)."""
        running = cls()
        running._horizontal_m = np.sort(horizontal_m[:-1]).tolist()
        running._sum_m = float(spatial_m[:-1].sum())
        running._sum_of_squares_m2 = float((spatial_m[:-1] ** 2).sum())
        return running, running.add(float(horizontal_m[-1]), float(spatial_m[-1]))

    def add(self, horizontal_m: float, spatial_m: float) -> ErrorSoFar:
        """One pair more."""
        insort(self._horizontal_m, horizontal_m)
        self._sum_m += spatial_m
        self._sum_of_squares_m2 += spatial_m**2
        count = len(self._horizontal_m)
        half, most = (self._quantile_m(share) for share in CIRCULAR)
        return ErrorSoFar(count, self._sum_m / count, math.sqrt(self._sum_of_squares_m2 / count), half, most)

    def _quantile_m(self, share: float) -> float:
        place = share * (len(self._horizontal_m) - 1)
        below = math.floor(place)
        above = min(below + 1, len(self._horizontal_m) - 1)
        least, most = self._horizontal_m[below], self._horizontal_m[above]
        return least + (place - below) * (most - least)
