"""What covers a plate from one of its sides, and how far in.

Five straight lines of black cross a plate between its dots from side to side, in both directions. Where something
stands before a side, a hand or a board or a door, they end in another colour; from there on the plate is hidden. What
lies outside the photograph is hidden as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.targets.layout import PLATE_SIDE_U
from app.vision.kernels.sides import SIDES, walk_lines
from app.vision.patches import LINEAR_FROM_CODED
from app.vision.proposals import GAPS_U

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Pixels = npt.NDArray[np.uint8]

LINES_U = np.array([-5.9, -3.0, 0.0, 3.0, 5.9])
# Plate coordinates of (across, from the side inwards), one row per side: top, right, bottom, left.
TURNS = np.array([[[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]]], dtype=np.float64)


@dataclass(frozen=True)
class SideOptions:
    """When a side counts as covered.

    Attributes
    ----------
    first_u, step_u, deepest_u : float
        Where the lines are looked at, from the plate's edge inwards: behind the blurred paper, half a dot's radius
        apart at most, and as far as leaves ``area_min`` of the plate.
    off_black_min : float
        Distance of a colour from the plate's black over the plate's red, linear light: in plain view up to 0.1, even
        with bright dots blurred into it.
    lines_min : int
        Lines of five that must end: a stain or a shadow's edge takes one or two.
    area_min : float
        Part of the plate that must be in sight: a board over a quarter of a side, and its blurred edge, leave 0.7.
    margin_u : float
        Beyond the last colour that is not black: the edge is blurred.
    """

    first_u: float = 0.6
    step_u: float = 0.25
    deepest_u: float = 5.2
    off_black_min: float = 0.14
    lines_min: int = 3
    area_min: float = 0.6
    margin_u: float = 0.35

    def inwards_u(self) -> Array:
        """Distances from the edge that are looked at, shape (D,)."""
        return np.arange(self.first_u, self.deepest_u + 0.5 * self.step_u, self.step_u)


@dataclass(frozen=True)
class CoveredSides:
    """What hides P plates.

    Attributes
    ----------
    depths_u : ndarray of shape (P, 4, 5)
        How far each side is covered on each line, top, right, bottom, left; 0 where it is not.
    black_share : ndarray of shape (P,)
        Part of the lines in sight that is black.
    """

    depths_u: Array
    black_share: Array

    def any(self) -> Mask:
        """Which plates are covered from some side, shape (P,)."""
        return np.asarray((self.depths_u > 0.0).any(axis=(1, 2)), dtype=np.bool_)

    def select(self, chosen: npt.NDArray[np.intp]) -> CoveredSides:
        """What hides some of the plates."""
        return CoveredSides(self.depths_u[chosen], self.black_share[chosen])

    def seen(self, points_u: Array) -> Mask:
        """Which plate points, of shape (S, 2), are in sight on each plate, shape (P, S)."""
        seen = np.ones((len(self.depths_u), len(points_u)), dtype=np.bool_)
        for side, turn in enumerate(TURNS):
            across_u, down_u = (points_u @ turn).T
            for plate in np.flatnonzero(self.depths_u[:, side].any(axis=1)):
                depth_u = np.interp(across_u, LINES_U, self.depths_u[plate, side])
                seen[plate] &= down_u + PLATE_SIDE_U / 2 > depth_u
        return seen


def covered_sides(
    bgr: Pixels, red: Array, image_from_plate: Array, options: SideOptions = SideOptions()
) -> CoveredSides:
    """Look along the lines of black of P plates.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    red : ndarray of shape (P,)
        The base dots' red above black, linear light.
    image_from_plate : ndarray of shape (P, 3, 3)
    """
    count, inwards_u = len(image_from_plate), options.inwards_u()
    leading, black_share = np.empty((count, SIDES, len(LINES_U)), dtype=np.int64), np.empty(count)
    limits = options.off_black_min * np.maximum(red, 1.0)
    tables = (LINEAR_FROM_CODED, GAPS_U, LINES_U, inwards_u)
    homographies = np.ascontiguousarray(image_from_plate)
    walk_lines(bgr, tables, homographies, limits, (options.lines_min, options.area_min), leading, black_share)
    ends_u = inwards_u[np.maximum(leading - 1, 0)] + options.margin_u
    return CoveredSides(np.where(leading > 0, ends_u, 0.0), black_share)
