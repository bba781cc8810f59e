"""Long series thinned for drawing: what is drawn is a part of them that holds their extremes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.services.reporting.numbers import count

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.intp]

GAP_STEPS = 5.0  # a line is broken where a step in time is so many times the usual one


def extreme_rows(series: Array, most: int) -> Rows:
    """Rows that hold the least and the greatest of each column in each of many stretches.

    Parameters
    ----------
    series : ndarray of shape (K, S)
        In the order of time.
    most : int
        Rows at most, about; fewer rows than these are all kept.

    Returns
    -------
    ndarray of int
        Increasing; the first and the last row are among them.
    """
    length, columns = series.shape
    if length <= most:
        return np.arange(length)
    stretches = np.array_split(np.arange(length), max(1, most // (2 * columns)))
    kept = {0, length - 1}
    for rows in stretches:
        part = series[rows]
        kept.update(rows[part.argmin(axis=0)].tolist(), rows[part.argmax(axis=0)].tolist())
    return np.array(sorted(kept), dtype=np.intp)


def distinct_rows(places: Array, spacing: float) -> Rows:
    """Rows of places, shape (K, 2), one for each square of a grid that holds any."""
    _, rows = np.unique(np.floor(places / spacing).astype(np.int64), axis=0, return_index=True)
    return np.sort(rows)


def spread_rows(values: Array, most: int, greatest: int) -> Rows:
    """Rows spread evenly, ``most`` about, and those of the greatest values, shape (K,); all when there are no more."""
    if len(values) <= most + greatest:
        return np.arange(len(values))
    even = np.linspace(0, len(values) - 1, most).astype(np.intp)
    return np.union1d(even, np.argpartition(values, -greatest)[-greatest:])


def moved_rows(places: Array, spacing: float) -> Rows:
    """Rows at which a path, shape (K, 2), enters another square of a grid; the first and the last row among them."""
    squares = np.floor(places / spacing)
    entered = (np.diff(squares, axis=0) != 0).any(axis=1)
    entered[-1:] = True
    return np.flatnonzero(np.concatenate([[True], entered]))


def unbroken(times_s: Array, rows: Rows, gap_s: float) -> list[Rows]:
    """Rows, increasing, in runs without a gap: whatever a gap parts in the whole series is parted."""
    run = np.concatenate([[0], np.cumsum(np.diff(times_s) > gap_s)])[rows]
    return np.split(rows, np.flatnonzero(np.diff(run)) + 1)


def usual_gap_s(times_s: Array) -> float:
    """Steps in time beyond which a line is broken."""
    steps_s = np.diff(times_s)
    return GAP_STEPS * float(np.median(steps_s)) if len(steps_s) else np.inf


def said(shown: int, total: int) -> str:
    """The sentence for a caption; nothing when all is drawn."""
    if shown == total:
        return ""
    return f" Of {count(total)} pairs {count(shown)} are drawn, the least and the greatest of every stretch among them."
