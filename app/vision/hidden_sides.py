"""Plates of which one side is hidden, with both of its corner dots: three red blobs, and where the others must be.

E and the two corners of a side fix an affinity, and with it where the other two corners are, but any three dots do.
What tells a plate is the rest: dots as long and as wide as the affinity makes a circle, black between them, and, later,
lines of black that end where something covers the side (``covered_sides``).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_NAMES
from app.vision.covered_sides import CoveredSides, SideOptions, covered_sides
from app.vision.dots import Blobs
from app.vision.grouping import GroupingOptions, nearest_of_like_size
from app.vision.homography import image_from_corner_dots
from app.vision.kernels.sides import SIDES
from app.vision.kernels.threes import find_threes, make_up_corners, measure_reds
from app.vision.patches import LINEAR_FROM_CODED
from app.vision.proposals import BASE_U, ProposalOptions, promising

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Pixels = npt.NDArray[np.uint8]

E = BASE_NAMES.index("E")
CORNERS = 4
# The corners that are seen, clockwise: of the top, the right, the bottom, the left side.
SEEN_CORNERS = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
HIDDEN_CORNERS = SEEN_CORNERS[[2, 3, 0, 1]]


def _inverse_by_side() -> Array:
    legs_u = BASE_U[SEEN_CORNERS] - BASE_U[E]  # (4, 2 corners, 2)
    return np.ascontiguousarray(np.linalg.inv(legs_u.transpose(0, 2, 1)))


INVERSE_BY_SIDE = _inverse_by_side()
ACROSS_U = np.ascontiguousarray(BASE_U[HIDDEN_CORNERS] - BASE_U[E])


@dataclass(frozen=True)
class HiddenSideOptions:
    """Which threes are tried.

    Attributes
    ----------
    neighbours : int
        Blobs around E that may be the two corners.
    blobs_max : int
        Free blobs that are looked at, strongest first: bounds the time a hostile picture can take.
    axes_off_max, axes_off_px : float
        How far the dots' semi-axes may be off those that the affinity gives, as part of these and in px besides:
        perspective, and outlines of small blobs.
    proposals : ProposalOptions
        What a group must show at first sight: of the 21 gaps eight are covered.
    """

    neighbours: int = 6
    blobs_max: int = 150
    axes_off_max: float = 0.25
    axes_off_px: float = 0.7
    proposals: ProposalOptions = field(default_factory=lambda: ProposalOptions(dark_gaps_min=12, proposals_max=100))


def complete_sides(
    blobs: Blobs, free: Indices, options: HiddenSideOptions = HiddenSideOptions()
) -> tuple[Blobs, Indices]:
    """Groups of five of which two neighbouring corners are made up.

    Parameters
    ----------
    blobs : Blobs
    free : ndarray of shape (F,)
        Indices of blobs that belong to no other plate, strongest first.

    Returns
    -------
    blobs : Blobs
        The given ones and, behind them, two for each group.
    groups : ndarray of shape (G, 5)
        A, B, C, D, E as indices of those.
    """
    chosen = free[: options.blobs_max]
    pool = Blobs(blobs.centres_px[chosen], blobs.semi_axes_px[chosen])
    nearest = nearest_of_like_size(pool, GroupingOptions(neighbours=options.neighbours))
    bounds = (options.axes_off_max, options.axes_off_px)
    threes = find_threes(pool.centres_px, pool.semi_axes_px, nearest, INVERSE_BY_SIDE, bounds)
    groups = np.empty((len(threes), len(BASE_NAMES)), dtype=np.intp)
    centres_px, semi_axes_px = np.empty((2, 2 * len(threes), 2))
    dots = (pool.centres_px, pool.semi_axes_px)
    make_up_corners(threes, dots, (INVERSE_BY_SIDE, ACROSS_U), groups, centres_px, semi_axes_px)
    extended = blobs.followed_by(centres_px, semi_axes_px)
    places = np.concatenate([chosen, len(blobs) + np.arange(2 * len(threes))])
    return extended, places[groups]


def behind_sides(
    bgr: Pixels, blobs: Blobs, free: Indices, options: HiddenSideOptions, sides: SideOptions
) -> tuple[Indices, CoveredSides]:
    """Plates of which a side is covered with both its corner dots, and what covers them.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    blobs : Blobs
    free : ndarray of shape (F,)
        Indices of blobs that belong to no other plate, strongest first.
    options : HiddenSideOptions
    sides : SideOptions

    Returns
    -------
    groups : ndarray of shape (G, 5)
        A, B, C, D, E as indices of blobs; beyond those given, of dots that are hidden.
    covered : CoveredSides
        Through the five dots: good to half a dot's radius.
    """
    extended, groups = complete_sides(blobs, free, options)
    groups = promising(bgr, extended, groups, options.proposals)
    base_px, made_up = extended.centres_px[groups], groups >= len(blobs)
    # Clockwise, the hidden side's second corner is the last that was made up.
    hidden_side = (np.argmax(groups[:, :CORNERS], axis=1) - 1) % SIDES
    image_from_plate = image_from_corner_dots(base_px[:, :CORNERS])
    covered = covered_sides(bgr, _red_of(bgr, base_px), image_from_plate, sides, hidden_side)
    # What was made up must be hidden, and what was seen in sight.
    suits = np.flatnonzero((covered.seen(BASE_U) != made_up).all(axis=1))
    return groups[suits], covered.select(suits)


def _red_of(bgr: Pixels, base_px: Array) -> Array:
    """Red of the third brightest of each group's five dots, shape (G,), linear light."""
    red = np.empty(len(base_px))
    measure_reds(bgr, LINEAR_FROM_CODED, base_px, red)
    return red
