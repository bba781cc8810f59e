"""Plates of which one base dot is hidden: four red blobs that no whole plate claims, and where the fifth must be.

Seen from some way off a plate's picture is nearly affine, and four of its five base dots then satisfy one linear
relation; the fifth follows from them. The template fit that comes after takes up the perspective.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np
import numpy.typing as npt

from app.vision.dots import Blobs
from app.vision.grouping import GroupingOptions, nearest_of_like_size
from app.vision.kernels.fours import find_fours, match_relations

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]


@dataclass(frozen=True)
class _Missing:
    """One base dot hidden: how the others are tied, and how they give the hidden one.

    Attributes
    ----------
    role : int
        The hidden dot: 0 ... 4 for A ... E.
    relation : tuple of float
        Weights of A, B, C, D, E whose sum vanishes on every affine view.
    prediction : tuple of float
        Weights of A, B, C, D, E that give the hidden dot.
    """

    role: int
    relation: tuple[float, ...]
    prediction: tuple[float, ...]


# From the plate's geometry: E lies at 1/3 of the way from A to C, and A + C = B + D.
MISSING = (
    _Missing(0, (0, 2, -1, 2, -3), (0, 1, -1, 1, 0)),
    _Missing(1, (2, 0, 1, 0, -3), (1, 0, 1, -1, 0)),
    _Missing(2, (1, 1, 0, 1, -3), (-1, 1, 0, 1, 0)),
    _Missing(3, (2, 0, 1, 0, -3), (1, -1, 1, 0, 0)),
    _Missing(4, (1, -1, 1, -1, 0), (2 / 3, 0, 1 / 3, 0, 0)),
)


@dataclass(frozen=True)
class _Cases:
    """All ways in which four blobs, in a given order, play four roles: five hidden dots times 24 orders.

    Attributes
    ----------
    hidden : ndarray of shape (120,)
        The hidden role.
    seen : ndarray of shape (120, 4)
        The role of each of the four blobs.
    predictions : ndarray of shape (120, 4)
        Weights of the four blobs.
    relations : ndarray of shape (R, 4)
        Weights of the four blobs, the greatest of them 1: fewer than cases, for several have one in common.
    of_relation : tuple of ndarray
        The cases of each relation.
    """

    hidden: Indices
    seen: Indices
    predictions: Array
    relations: Array
    of_relation: tuple[Indices, ...]


def _all_cases() -> _Cases:
    rows = [
        (missing, np.array([role for role in range(5) if role != missing.role])[list(order)])
        for missing in MISSING
        for order in permutations(range(4))
    ]
    seen = np.array([roles for _, roles in rows], dtype=np.intp)
    relations = np.array([np.array(missing.relation, dtype=np.float64)[roles] for missing, roles in rows])
    distinct, number = np.unique(relations / np.abs(relations).max(axis=1, keepdims=True), axis=0, return_inverse=True)
    return _Cases(
        hidden=np.array([missing.role for missing, _ in rows], dtype=np.intp),
        seen=seen,
        relations=distinct,
        of_relation=tuple(np.flatnonzero(number == relation) for relation in range(len(distinct))),
        predictions=np.array([np.array(missing.prediction, dtype=np.float64)[roles] for missing, roles in rows]),
    )


CASES = _all_cases()


@dataclass(frozen=True)
class HiddenDotOptions:
    """Which fours are tried.

    Attributes
    ----------
    neighbours : int
        Blobs around one of the four that may be the other three.
    blobs_max : int
        Free blobs that are looked at, strongest first: bounds the time a hostile picture can take.
    relation_max_axes : float
        How far the affine relation may be missed, in semi-axes of a dot: perspective and noise of small blobs.
    extent_axes : float
        Farthest that two of the four may stand apart: the diagonal has 12.7 radii; outlines scatter.
    """

    neighbours: int = 6
    blobs_max: int = 150
    relation_max_axes: float = 0.8
    extent_axes: float = 20.0


def complete_groups(
    blobs: Blobs, free: Indices, options: HiddenDotOptions = HiddenDotOptions()
) -> tuple[Blobs, Indices]:
    """Groups of five of which one dot is made up.

    Parameters
    ----------
    blobs : Blobs
    free : ndarray of shape (F,)
        Indices of blobs that belong to no whole plate, strongest first.

    Returns
    -------
    blobs : Blobs
        The given ones and, behind them, one for each hidden dot.
    groups : ndarray of shape (G, 5)
        A, B, C, D, E as indices of those.
    """
    chosen = free[: options.blobs_max]
    pool = Blobs(blobs.centres_px[chosen], blobs.semi_axes_px[chosen])
    if len(pool) < 4:
        return blobs, np.empty((0, 5), dtype=np.intp)
    nearest = nearest_of_like_size(pool, GroupingOptions(neighbours=options.neighbours))
    fours = find_fours(pool.centres_px, pool.semi_axes_px, nearest, options.extent_axes)
    matches = match_relations(pool.centres_px, pool.semi_axes_px, fours, CASES.relations, options.relation_max_axes)
    case = np.concatenate([CASES.of_relation[relation] for _, relation in matches] or [matches[:0, 0]])
    four = np.repeat(matches[:, 0], [len(CASES.of_relation[relation]) for _, relation in matches])
    seen, hidden = CASES.seen[case], CASES.hidden[case]
    count = len(four)
    groups = np.empty((count, 5), dtype=np.intp)
    groups[np.arange(count)[:, None], seen] = chosen[fours[four]]
    groups[np.arange(count), hidden] = len(blobs) + np.arange(count)
    centres_px = np.einsum("gr,grc->gc", CASES.predictions[case], pool.centres_px[fours[four]])
    semi_axes_px = pool.semi_axes_px[fours[four]].mean(axis=1)
    return blobs.followed_by(centres_px, semi_axes_px), groups
