"""What covers a plate from one of its sides, and how far in.

Five straight lines of black cross a plate between its dots from side to side, in both directions. Where something
stands before a side, a hand or a board or a door, they end in another colour; from there on the plate is hidden. What
lies outside the photograph is hidden as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.vision.kernels.sides import ANY_SIDE, SIDES, walk_lines
from app.vision.kernels.sight import mark_seen
from app.vision.patches import LINEAR_FROM_CODED
from app.vision.proposals import GAPS_U

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]
Pixels = npt.NDArray[np.uint8]

LINES_U = np.array([-5.9, -3.0, 0.0, 3.0, 5.9])


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
    black_share_min : float
        Part of the lines of black in sight that must be black: cloth and walls are not.
    margin_u : float
        Beyond the last colour that is not black: the edge is blurred.
    """

    first_u: float = 0.6
    step_u: float = 0.25
    deepest_u: float = 5.2
    off_black_min: float = 0.14
    lines_min: int = 3
    area_min: float = 0.6
    black_share_min: float = 0.85
    margin_u: float = 0.35

    def inwards_u(self) -> Array:
        """Distances from the edge that are looked at, shape (D,)."""
        return np.arange(self.first_u, self.deepest_u + 0.5 * self.step_u, self.step_u)


@dataclass(frozen=True)
class CoveredSides:
    """What hides P plates.

    Attributes
    ----------
    image_from_plate : ndarray of shape (P, 3, 3)
        Where they are.
    red : ndarray of shape (P,)
        The base dots' red above black, linear light.
    depths_u : ndarray of shape (P, 4, 5)
        How far each side is covered on each line, top, right, bottom, left; 0 where it is not. Of plates whose lines
        are not black in sight, nothing.
    """

    image_from_plate: Array
    red: Array
    depths_u: Array

    def covered(self) -> Indices:
        """The plates that are covered from some side, and black beside that."""
        return np.flatnonzero((self.depths_u > 0.0).any(axis=(1, 2)))

    def select(self, chosen: Indices) -> CoveredSides:
        """What hides some of the plates."""
        return CoveredSides(self.image_from_plate[chosen], self.red[chosen], self.depths_u[chosen])

    def seen(self, points_u: Array) -> Mask:
        """Which plate points, of shape (S, 2), are in sight on each plate, shape (P, S)."""
        seen = np.empty((len(self.depths_u), len(points_u)), dtype=np.bool_)
        mark_seen(self.depths_u, LINES_U, points_u, seen)
        return seen


def covered_sides(
    bgr: Pixels,
    red: Array,
    image_from_plate: Array,
    options: SideOptions = SideOptions(),
    must: Indices | None = None,
) -> CoveredSides:
    """Look along the lines of black of P plates.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    red : ndarray of shape (P,)
        The base dots' red above black, linear light.
    image_from_plate : ndarray of shape (P, 3, 3)
    options : SideOptions
    must : ndarray of shape (P,), optional
        The side that must be covered, 0 to 3.
    """
    count = len(image_from_plate)
    depths_u = np.empty((count, SIDES, len(LINES_U)))
    if must is None:
        must = np.full(count, ANY_SIDE)
    tables = (LINEAR_FROM_CODED, GAPS_U, LINES_U, options.inwards_u())
    limits = options.off_black_min * np.maximum(red, 1.0)
    bounds = (options.lines_min, options.area_min, options.black_share_min, options.margin_u)
    homographies = np.ascontiguousarray(image_from_plate)
    walk_lines(bgr, tables, homographies, limits, must, bounds, depths_u)
    return CoveredSides(homographies, red, depths_u)
