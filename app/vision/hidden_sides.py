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
from app.vision.dots import Blobs, sample_rows
from app.vision.grouping import GroupingOptions, nearest_of_like_size
from app.vision.kernels.inkwell import RED
from app.vision.kernels.threes import find_threes
from app.vision.patches import LINEAR_FROM_CODED
from app.vision.proposals import BASE_U, ProposalOptions

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Pixels = npt.NDArray[np.uint8]

E = BASE_NAMES.index("E")
# The corners that are seen, clockwise: of the top, the right, the bottom, the left side.
SEEN_CORNERS = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
HIDDEN_CORNERS = SEEN_CORNERS[[2, 3, 0, 1]]


def _inverse_by_side() -> Array:
    legs_u = BASE_U[SEEN_CORNERS] - BASE_U[E]  # (4, 2 corners, 2)
    return np.ascontiguousarray(np.linalg.inv(legs_u.transpose(0, 2, 1)))


INVERSE_BY_SIDE = _inverse_by_side()


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
    seen, side, count = threes[:, :3], threes[:, 3], len(threes)
    legs_px = pool.centres_px[seen[:, 1:]] - pool.centres_px[seen[:, :1]]  # (G, 2 corners, 2)
    px_per_u = legs_px.transpose(0, 2, 1) @ INVERSE_BY_SIDE[side]
    offset_u = BASE_U[HIDDEN_CORNERS[side]] - BASE_U[E]
    centres_px = pool.centres_px[seen[:, :1]] + offset_u @ px_per_u.transpose(0, 2, 1)
    semi_axes_px = np.repeat(pool.semi_axes_px[seen].mean(axis=1), 2, axis=0)
    groups, row = np.empty((count, len(BASE_NAMES)), dtype=np.intp), np.arange(count)[:, None]
    groups[:, E] = chosen[seen[:, 0]]
    groups[row, SEEN_CORNERS[side]] = chosen[seen[:, 1:]]
    groups[row, HIDDEN_CORNERS[side]] = len(blobs) + np.arange(2 * count).reshape(count, 2)
    extended = Blobs(
        np.concatenate([blobs.centres_px, centres_px.reshape(-1, 2)]),
        np.concatenate([blobs.semi_axes_px, semi_axes_px]),
    )
    return extended, groups


def red_of_blobs(bgr: Pixels, blobs: Blobs, groups: Indices) -> Array:
    """Red of the third brightest of each group's five dots, shape (G,), linear light."""
    if not len(groups):
        return np.zeros(0)
    coded = sample_rows(bgr, blobs.centres_px[groups])[..., RED]
    result: Array = np.sort(LINEAR_FROM_CODED[np.rint(coded).astype(np.intp)], axis=1)[:, 2].astype(np.float64)
    return result
