"""Plates of which one base dot is hidden: four red blobs that no whole plate claims, and where the fifth must be.

Seen from some way off a plate's picture is nearly affine, and four of its five base dots then satisfy one linear
relation; the fifth follows from them. The template fit that comes after takes up the perspective.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np
import numpy.typing as npt

from app.vision.dots import Blobs
from app.vision.grouping import GroupingOptions, neighbours_of_like_size

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
    relations, predictions : ndarray of shape (120, 4)
        Weights of the four blobs; a relation's greatest weight is 1.
    """

    hidden: Indices
    seen: Indices
    relations: Array
    predictions: Array


def _all_cases() -> _Cases:
    rows = [
        (missing, np.array([role for role in range(5) if role != missing.role])[list(order)])
        for missing in MISSING
        for order in permutations(range(4))
    ]
    seen = np.array([roles for _, roles in rows], dtype=np.intp)
    relations = np.array([np.array(missing.relation, dtype=np.float64)[roles] for missing, roles in rows])
    return _Cases(
        hidden=np.array([missing.role for missing, _ in rows], dtype=np.intp),
        seen=seen,
        relations=relations / np.abs(relations).max(axis=1, keepdims=True),
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
    fours = _near_fours(pool, options)
    four, case = np.nonzero(_related(pool, fours, options))
    seen, hidden = CASES.seen[case], CASES.hidden[case]
    count = len(four)
    groups = np.empty((count, 5), dtype=np.intp)
    groups[np.arange(count)[:, None], seen] = chosen[fours[four]]
    groups[np.arange(count), hidden] = len(blobs) + np.arange(count)
    centres_px = np.einsum("gr,grc->gc", CASES.predictions[case], pool.centres_px[fours[four]])
    semi_axes_px = pool.semi_axes_px[fours[four]].mean(axis=1)
    extended = Blobs(np.concatenate([blobs.centres_px, centres_px]), np.concatenate([blobs.semi_axes_px, semi_axes_px]))
    return extended, groups


def _near_fours(pool: Blobs, options: HiddenDotOptions) -> Indices:
    """Sets of four blobs of like size that stand together, shape (M, 4), each set once."""
    nearest, alike = neighbours_of_like_size(pool, GroupingOptions(neighbours=options.neighbours))
    slots = np.array(list(combinations(range(options.neighbours), 3)))
    anchor = np.repeat(np.arange(len(pool)), len(slots))
    fours = np.column_stack([anchor, nearest[:, slots].reshape(-1, 3)])[alike[:, slots].all(axis=2).ravel()]
    fours = np.unique(np.sort(fours, axis=1), axis=0)
    corners_px = pool.centres_px[fours]
    extent_px = np.linalg.norm(corners_px.max(axis=1) - corners_px.min(axis=1), axis=1)
    return fours[extent_px < options.extent_axes * pool.semi_axes_px[fours, 0].mean(axis=1)]


def _related(pool: Blobs, fours: Indices, options: HiddenDotOptions) -> npt.NDArray[np.bool_]:
    """In which cases each four satisfies the affine relation of the roles it would play, shape (M, 120)."""
    gap_px = np.linalg.norm(np.einsum("qr,mrc->mqc", CASES.relations, pool.centres_px[fours]), axis=2)
    radius_px = pool.semi_axes_px[fours, 0].mean(axis=1)
    result: npt.NDArray[np.bool_] = gap_px < options.relation_max_axes * radius_px[:, None]
    return result
