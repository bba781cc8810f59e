"""The constant offset between two clocks, from the shapes of the two walks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from app.errors import DegenerateGeometry
from app.geometry.rotation import skew
from app.trajectories.alignment import Alignment, AlignmentOptions, align
from app.trajectories.association import AssociationOptions, Pairs, associate
from app.trajectories.metrics.bootstrap import correlation_length
from app.trajectories.no_match import NothingMatched
from app.trajectories.trajectory import Array, Trajectory


@dataclass(frozen=True)
class OffsetOptions:
    """Where to look, and what to believe.

    Attributes
    ----------
    greatest_s : float
        Offsets up to this are tried.
    step_s : float
        Of the first search: half the time in which a walker turns a corner, so that no minimum is stepped over.
    least_overlap : float
        Share of the pairs at the best-covered offset that another offset must keep to be believed.
    least_movement : float
        Share of the velocities that the alignment cannot imitate, below which the walk tells no offset: on a straight
        line at an even pace a shift in time and one in space are the same.
    """

    greatest_s: float = 60.0
    step_s: float = 0.25
    least_overlap: float = 0.5
    least_movement: float = 1e-3


@dataclass(frozen=True)
class TimeOffset:
    """What the reference's clock shows more than the estimate's.

    Attributes
    ----------
    offset_s, sigma_s : float
    """

    offset_s: float
    sigma_s: float


def estimate_time_offset(
    reference: Trajectory,
    estimate: Trajectory,
    association: AssociationOptions,
    alignment: AlignmentOptions,
    options: OffsetOptions | None = None,
) -> TimeOffset:
    """The offset at which the aligned walks lie closest.

    Parameters
    ----------
    reference, estimate : Trajectory
    association : AssociationOptions
        The reference is interpolated, whatever kind of association is asked for: other kinds jump with the offset.
    alignment : AlignmentOptions
        Used anew at each offset.
    options : OffsetOptions, optional

    Raises
    ------
    NothingMatched
        When no offset brings the two together.
    DegenerateGeometry
        When the walk is such that its shape tells no offset.

    Notes
    -----
    The sigma is that of the linear model ``residual = v * offset`` with the alignment's parameters projected out,
    summed in blocks of residuals that are correlated (Newey and West's idea, Econometrica 55(3), 1987).
    """
    options = options or OffsetOptions()
    smooth = AssociationOptions("interpolate", association.max_gap_s, "spline")
    search = _Search(reference, estimate, smooth, alignment)
    offset_s = search.best(options)
    return TimeOffset(offset_s, _sigma_s(reference, search.pairs(offset_s), alignment, options))


@dataclass(frozen=True)
class _Search:
    """Cost of offsets: mean squared distance of the aligned pairs."""

    reference: Trajectory
    estimate: Trajectory
    association: AssociationOptions
    alignment: AlignmentOptions

    def pairs(self, offset_s: float) -> Pairs:
        return associate(self.reference, self.estimate, self.association, offset_s)

    def cost(self, offset_s: float) -> tuple[float, int]:
        """Mean square (m^2) and number of pairs; infinite where there are too few."""
        try:
            pairs = self.pairs(offset_s)
            aligned_m = align(pairs, self.alignment).apply(pairs.estimate).positions_m
        except (NothingMatched, DegenerateGeometry):
            return np.inf, 0
        return float(((aligned_m - pairs.reference.positions_m) ** 2).sum(axis=1).mean()), len(pairs)

    def best(self, options: OffsetOptions) -> float:
        count = int(np.ceil(options.greatest_s / options.step_s))
        offsets_s = np.arange(-count, count + 1) * options.step_s
        costs = [self.cost(offset_s) for offset_s in offsets_s]
        most = max(pair_count for _, pair_count in costs)
        if most == 0:
            self.pairs(0.0)  # says why
            raise DegenerateGeometry("no offset gives pairs that fix the alignment: give time_offset_s")
        believed = [cost if pairs >= options.least_overlap * most else np.inf for cost, pairs in costs]
        coarse_s = float(offsets_s[int(np.argmin(believed))])
        around = coarse_s - options.step_s, coarse_s + options.step_s
        found = minimize_scalar(lambda s: self.cost(float(s))[0], bounds=around, method="bounded")
        return float(found.x)


def _sigma_s(reference: Trajectory, pairs: Pairs, alignment: AlignmentOptions, options: OffsetOptions) -> float:
    found = align(pairs, alignment)
    residuals_m = pairs.reference.positions_m - found.apply(pairs.estimate).positions_m
    velocities_m_s = _velocities_m_s(reference, pairs.reference.times_s)
    moved = _beyond_alignment(velocities_m_s, pairs.reference.positions_m, found)
    squares = float((moved**2).sum())
    if squares <= options.least_movement * float((velocities_m_s**2).sum()):
        raise DegenerateGeometry(
            "the walk tells no offset: it stands still, or goes straight at an even pace, where a shift in time is one "
            "in space; give time_offset_s"
        )
    products = (moved * residuals_m).sum(axis=1)
    block = correlation_length(products)
    sums = np.add.reduceat(products, np.arange(0, len(products), block))
    return float(np.sqrt((sums**2).sum()) / squares)


def _velocities_m_s(reference: Trajectory, times_s: Array) -> Array:
    """Velocity of the reference at each time, shape (K, 3): that of the chord around it."""
    right = np.clip(np.searchsorted(reference.times_s, times_s), 1, len(reference) - 1)
    step_s = reference.times_s[right] - reference.times_s[right - 1]
    chord_m = reference.positions_m[right] - reference.positions_m[right - 1]
    return np.divide(chord_m, step_s[:, None], out=np.zeros_like(chord_m), where=step_s[:, None] > 0)


def _beyond_alignment(velocities_m_s: Array, positions_m: Array, found: Alignment) -> Array:
    """Velocities without what a change of the alignment could do as well, shape (K, 3)."""
    columns = _freedoms(positions_m - positions_m.mean(axis=0), found)
    if columns is None:
        return velocities_m_s
    flat = velocities_m_s.reshape(-1)
    imitated = columns @ np.linalg.lstsq(columns, flat, rcond=None)[0]
    return (flat - imitated).reshape(-1, 3)


def _freedoms(centred_m: Array, found: Alignment) -> Array | None:
    """How positions change with the alignment's parameters, shape (3 K, P); None when none is free."""
    count = len(centred_m)
    shift = np.tile(np.eye(3), (count, 1))
    turn = -skew(centred_m).reshape(-1, 3)
    scale = centred_m.reshape(-1, 1)
    if found.kind == "posyaw":
        return np.hstack([shift, turn[:, 2:]])
    if found.kind in ("se3", "first_n"):
        return np.hstack([shift, turn])
    return np.hstack([shift, turn, scale]) if found.kind == "sim3" else None
