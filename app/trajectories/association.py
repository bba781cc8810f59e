"""Which pose of the reference belongs to which of the estimate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.trajectories.interpolation import Course, find_between, interpolate
from app.trajectories.no_match import nothing_matched
from app.trajectories.trajectory import Array, Trajectory

Association = Literal["interpolate", "nearest", "last"]
Rows = npt.NDArray[np.intp]


@dataclass(frozen=True)
class AssociationOptions:
    """How poses are paired.

    Attributes
    ----------
    association : {"interpolate", "nearest", "last"}
        ``interpolate``: the reference is interpolated at each stamp of the estimate. ``nearest``: each pose of the
        shorter trajectory with the nearest of the longer, as the tool evo does. ``last``: each pose of the reference
        with what the system had said last at that moment, as EvAAL does.
    max_gap_s : float
        ``interpolate``: largest distance of the two reference poses around; else largest distance of a pair. By default
        a second: someone who walks may then stray some 0.1 m from the line between two poses (1 m/s^2 over a second).
    course : {"linear", "spline"}
        Of the interpolated positions.
    """

    association: Association = "interpolate"
    max_gap_s: float = 1.0
    course: Course = "linear"

    def __post_init__(self) -> None:
        if not self.max_gap_s >= 0:
            raise ValueError(f"max_gap_s must not be negative, got {self.max_gap_s}")


@dataclass(frozen=True)
class Pairs:
    """K poses of the reference and the estimate's, one for one.

    Attributes
    ----------
    reference, estimate : Trajectory
        Of K poses each; both with stamps of the reference's clock.
    estimate_rows : ndarray of int, shape (K,)
        Which poses of the whole estimate these are.
    estimate_count : int
        How many poses the whole estimate has.
    """

    reference: Trajectory
    estimate: Trajectory
    estimate_rows: Rows
    estimate_count: int

    def __post_init__(self) -> None:
        if not len(self.reference) == len(self.estimate) == len(self.estimate_rows):
            raise ValueError("pairs take as many poses of the reference as of the estimate")

    def __len__(self) -> int:
        return len(self.reference)

    def first(self, count: int) -> Pairs:
        """The first pairs."""
        rows = np.arange(min(count, len(self)))
        taken = self.reference.take(rows), self.estimate.take(rows)
        return Pairs(*taken, self.estimate_rows[rows], self.estimate_count)


def associate(
    reference: Trajectory,
    estimate: Trajectory,
    options: AssociationOptions | None = None,
    time_offset_s: float = 0.0,
) -> Pairs:
    """Pair the poses of two trajectories.

    Parameters
    ----------
    reference, estimate : Trajectory
    options : AssociationOptions, optional
    time_offset_s : float
        The reference's clock reads the estimate's stamp plus this.

    Raises
    ------
    NothingMatched
        When no pose has a partner: says why, and what to try.
    """
    options = options or AssociationOptions()
    shifted = estimate.shifted(time_offset_s)
    pair = {"interpolate": _interpolated, "nearest": _nearest, "last": _last}[options.association]
    pairs = pair(reference, shifted, options)
    if len(pairs) == 0:
        raise nothing_matched(reference.times_s, estimate.times_s, time_offset_s, options.max_gap_s)
    return pairs


def _interpolated(reference: Trajectory, estimate: Trajectory, options: AssociationOptions) -> Pairs:
    rows = np.flatnonzero(find_between(reference.times_s, estimate.times_s, options.max_gap_s).inside)
    there = interpolate(reference, estimate.times_s, options.max_gap_s, options.course)
    return Pairs(there, estimate.take(rows), rows, len(estimate))


def _nearest(reference: Trajectory, estimate: Trajectory, options: AssociationOptions) -> Pairs:
    reference_is_longer = len(reference) >= len(estimate)
    shorter, longer = (estimate, reference) if reference_is_longer else (reference, estimate)
    partner = nearest_rows(longer.times_s, shorter.times_s)
    near = _close(longer, partner, shorter.times_s, options.max_gap_s)
    kept, partner = np.flatnonzero(near), partner[near]
    rows = (partner, kept) if reference_is_longer else (kept, partner)
    return _pairs_of_rows(reference, estimate, *rows)


def _last(reference: Trajectory, estimate: Trajectory, options: AssociationOptions) -> Pairs:
    partner = np.searchsorted(estimate.times_s, reference.times_s, side="right") - 1
    near = (partner >= 0) & _close(estimate, partner, reference.times_s, options.max_gap_s)
    return _pairs_of_rows(reference, estimate, np.flatnonzero(near), partner[near])


def _pairs_of_rows(reference: Trajectory, estimate: Trajectory, reference_rows: Rows, estimate_rows: Rows) -> Pairs:
    """Pairs at the reference's own poses; their moment is the reference's."""
    return Pairs(reference.take(reference_rows), estimate.take(estimate_rows), estimate_rows, len(estimate))


def nearest_rows(stamps_s: Array, times_s: Array) -> Rows:
    """The row of the nearest stamp to each time, shape (K,); of two equally near the earlier."""
    if len(stamps_s) == 0:
        return np.zeros(len(times_s), dtype=np.intp)
    right = np.clip(np.searchsorted(stamps_s, times_s), 1, max(len(stamps_s) - 1, 1))
    left = right - 1
    right = np.minimum(right, len(stamps_s) - 1)
    return np.where(times_s - stamps_s[left] <= stamps_s[right] - times_s, left, right)


def _close(trajectory: Trajectory, rows: Rows, times_s: Array, max_gap_s: float) -> npt.NDArray[np.bool_]:
    if len(trajectory) == 0:
        return np.zeros(len(times_s), dtype=np.bool_)
    return np.abs(trajectory.times_s[rows] - times_s) <= max_gap_s
