"""How much of the walk the system had an answer for, and how late the answers came."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.trajectories.metrics.summary import Summary, summarise
from app.trajectories.trajectory import Array, Trajectory


@dataclass(frozen=True)
class Availability:
    """The reference's time that estimates cover.

    Attributes
    ----------
    covered_share : float
        Share of the reference's poses that have an estimate no farther than ``max_gap_s`` (ISO/IEC 18305's coverage, in
        time).
    longest_silence_s : float
        Longest time within the reference's without an estimate.
    latency_s : Summary or None
        How long after their moment the estimates arrived; None when their source told no arrivals.
    """

    covered_share: float
    longest_silence_s: float
    latency_s: Summary | None = None


def availability_of(reference_s: Array, estimate: Trajectory, max_gap_s: float) -> Availability:
    """The availability of a trajectory whose stamps are by the reference's clock."""
    found = availability(reference_s, estimate.times_s, max_gap_s)
    if estimate.arrived_s is None or len(estimate) == 0:
        return found
    return replace(found, latency_s=latency(estimate.times_s, estimate.arrived_s))


def availability(reference_s: Array, estimate_s: Array, max_gap_s: float) -> Availability:
    """What share of the reference has an estimate near it; stamps by one clock, never decreasing, one at least."""
    right = np.searchsorted(estimate_s, reference_s)
    padded = np.concatenate([[-np.inf], estimate_s, [np.inf]])
    nearest_s = np.minimum(reference_s - padded[right], padded[right + 1] - reference_s)
    within = estimate_s[(estimate_s >= reference_s[0]) & (estimate_s <= reference_s[-1])]
    silences_s = np.diff(np.concatenate([reference_s[:1], within, reference_s[-1:]]))
    return Availability(float((nearest_s <= max_gap_s).mean()), float(silences_s.max()))


def latency(stamps_s: Array, arrived_s: Array) -> Summary:
    """How long after their moment answers arrived, in seconds; both of shape (K,), of one clock."""
    return summarise(arrived_s - stamps_s)
