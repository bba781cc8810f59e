"""Errors by zone: polygons in the plan, and whatever lies in none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.trajectories.metrics.accuracy import Accuracy, accuracy_of
from app.trajectories.metrics.errors import Errors
from app.trajectories.trajectory import Array

LEAST_CORNERS = 3
ELSEWHERE = "elsewhere"


@dataclass(frozen=True)
class Zone:
    """A named part of the plan.

    Attributes
    ----------
    name : str
    corners_m : ndarray of shape (N, 2)
        A polygon without holes; it closes itself. A point on an edge belongs to one side of it.
    """

    name: str
    corners_m: Array

    def __post_init__(self) -> None:
        shape = self.corners_m.shape
        if len(shape) != 2 or shape[0] < LEAST_CORNERS or shape[1] != 2 or not np.isfinite(self.corners_m).all():
            raise ValueError(f"zone {self.name} takes {LEAST_CORNERS} or more finite corners (x_m, y_m), got {shape}")

    def contains(self, points_m: Array) -> npt.NDArray[np.bool_]:
        """Whether each point of shape (K, 2) lies inside, by the parity of the edges to its right."""
        inside = np.zeros(len(points_m), dtype=np.bool_)
        x, y = points_m[:, 0], points_m[:, 1]
        for (x0, y0), (x1, y1) in zip(self.corners_m, np.roll(self.corners_m, -1, axis=0), strict=True):
            crosses = (y0 > y) != (y1 > y)
            reach = np.divide(y - y0, y1 - y0, out=np.zeros_like(y), where=crosses)
            inside ^= crosses & (x < x0 + reach * (x1 - x0))
        return inside


def accuracy_by_zone(errors: Errors, positions_m: Array, zones: Sequence[Zone]) -> dict[str, Accuracy]:
    """Accuracy in each zone that has a pair, by the reference's positions, shape (K, 3); a pair may be in several."""
    return {name: accuracy_of(errors.take(rows)) for name, rows in rows_by_zone(positions_m, zones).items()}


def rows_by_zone(positions_m: Array, zones: Sequence[Zone]) -> dict[str, npt.NDArray[np.bool_]]:
    """Which positions, shape (K, 3), lie in each zone that has any, and in none; without zones there is nothing."""
    table: dict[str, npt.NDArray[np.bool_]] = {}
    somewhere = np.zeros(len(positions_m), dtype=np.bool_)
    for zone in zones:
        inside = zone.contains(positions_m[:, :2])
        somewhere |= inside
        if inside.any():
            table[zone.name] = inside
    if zones and not somewhere.all():
        table[ELSEWHERE] = ~somewhere
    return table
