"""What the pairs of a live evaluation amount to as they come, and how each is told."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from app.storage.live_records import LiveOptions, LivePair
from app.trajectories.alignment import Alignment, AlignmentOptions
from app.trajectories.metrics.running import ErrorSoFar, RunningErrors
from app.trajectories.metrics.running_aligned import AlignedRunningErrors


@dataclass(frozen=True)
class Tally:
    """All pairs until now.

    Attributes
    ----------
    so_far : ErrorSoFar or None
        None without a pair, or while the pairs do not fix the alignment.
    alignment : Alignment or None
        None when none was asked for, or while the pairs do not fix it.
    latency_s : float or None
        Median of how long after their moment the samples came; None when that is not known.
    """

    so_far: ErrorSoFar | None = None
    alignment: Alignment | None = None
    latency_s: float | None = None


class LiveTally:
    """The pairs of one live evaluation in the order in which they were found.

    Parameters
    ----------
    options : LiveOptions
    """

    def __init__(self, options: LiveOptions) -> None:
        self._options = options
        self._plain = RunningErrors()
        aligned = options.alignment != "none"
        self._aligned = AlignedRunningErrors(_alignment(options)) if aligned else None
        self._latencies = RunningErrors()
        self.tally = Tally()

    def add(self, pair: LivePair) -> None:
        """One pair more."""
        so_far, alignment = self._errors(pair)
        latency_s = latency_of(pair, self._options)
        told_s = self.tally.latency_s if latency_s is None else self._latencies.add(latency_s, latency_s).ce50_m
        self.tally = Tally(so_far, alignment, told_s)

    def shown(self, pair: LivePair) -> LivePair:
        """A pair with its error in the reference's frame; its angle is not known there."""
        if self._aligned is None or self._aligned.alignment is None:
            return pair
        position_m, reference_m = _both_m(pair)
        x_m, y_m, z_m = (self._aligned.aligned_m(position_m) - reference_m).tolist()
        return replace(pair, error_m=(x_m, y_m, None if pair.error_m[2] is None else z_m), angle_rad=None)

    def _errors(self, pair: LivePair) -> tuple[ErrorSoFar | None, Alignment | None]:
        if self._aligned is None:
            return self._plain.add(*distances_m(pair)), None
        self._aligned.add(*_both_m(pair))
        return self._aligned.so_far, self._aligned.alignment


def distances_m(pair: LivePair) -> tuple[float, float]:
    """Lengths of a pair's error in the plan and in space; without a height the plan is all there is."""
    x_m, y_m, z_m = pair.error_m
    horizontal_m = math.hypot(x_m, y_m)
    return horizontal_m, math.hypot(horizontal_m, z_m or 0.0)


def latency_of(pair: LivePair, options: LiveOptions) -> float | None:
    """How long after its moment a sample came, by the reference's clock; None when its arrival was not kept."""
    return None if pair.arrived_s is None else pair.arrived_s - (pair.time_s + options.time_offset_s)


def _alignment(options: LiveOptions) -> AlignmentOptions:
    return AlignmentOptions(options.alignment, options.first_n)


def _both_m(pair: LivePair) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """The sample's position and the reference's; a system that tells the plan alone is aligned in the plan."""
    x_m, y_m, z_m = pair.position_m
    position_m = (x_m, y_m, z_m or 0.0)
    error_m = np.array([value or 0.0 for value in pair.error_m])
    x_m, y_m, z_m = (np.array(position_m) - error_m).tolist()
    return position_m, (x_m, y_m, z_m)
