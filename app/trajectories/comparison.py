"""Several systems, or runs of one, against the same reference: each by itself, and each less each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from app.trajectories.association import nearest_rows
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.bootstrap import BootstrapOptions, Interval, paired_difference


@dataclass(frozen=True)
class Difference:
    """Two systems at the moments for which both have an answer.

    Attributes
    ----------
    first, second : str
    common : int
        Moments of the reference that both were compared at.
    mean_m : Interval or None
        Mean spatial error of the first less the second's; None without a common moment.
    """

    first: str
    second: str
    common: int
    mean_m: Interval | None

    @property
    def better(self) -> str | None:
        """Which is better beyond doubt; None when the interval holds 0."""
        if self.mean_m is None or self.mean_m.low <= 0.0 <= self.mean_m.high:
            return None
        return self.first if self.mean_m.value < 0 else self.second


def compare(
    evaluations: Mapping[str, Evaluation], same_moment_s: float, options: BootstrapOptions | None = None
) -> tuple[Difference, ...]:
    """Paired differences of every two systems.

    Parameters
    ----------
    evaluations : mapping of Evaluation by name
        Against one reference.
    same_moment_s : float
        Systems answer at moments of their own: pairs this near in time are compared.
    options : BootstrapOptions, optional
    """
    return tuple(
        _difference((first, evaluations[first]), (second, evaluations[second]), same_moment_s, options)
        for first, second in combinations(evaluations, 2)
    )


def _difference(
    first: tuple[str, Evaluation],
    second: tuple[str, Evaluation],
    same_moment_s: float,
    options: BootstrapOptions | None,
) -> Difference:
    times_s, others_s = first[1].errors.times_s, second[1].errors.times_s
    partner = nearest_rows(others_s, times_s)
    near = np.abs(others_s[partner] - times_s) <= same_moment_s
    if not near.any():
        return Difference(first[0], second[0], 0, None)
    distances_m = first[1].errors.spatial_m[near], second[1].errors.spatial_m[partner[near]]
    return Difference(first[0], second[0], int(near.sum()), paired_difference(*distances_m, options))
