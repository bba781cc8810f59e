"""The error so far of a system in a frame of its own: aligned anew as pairs come."""

from __future__ import annotations

import numpy as np

from app.errors import DegenerateGeometry
from app.trajectories.alignment import Alignment, AlignmentOptions, align
from app.trajectories.association import Pairs
from app.trajectories.metrics.running import ErrorSoFar, RunningErrors
from app.trajectories.trajectory import Array, Trajectory

GROWTH = 0.01  # pairs more, as a share, after which the frame is fitted anew: it moves less than its pairs scatter


class AlignedRunningErrors:
    """Pairs in the order in which they come, and the alignment of those up to the last fit.

    When a fit is made depends on the number of pairs alone, so the same pairs in the same order give the same numbers.

    Parameters
    ----------
    options : AlignmentOptions
        Any but ``origin``, which takes orientations.
    """

    def __init__(self, options: AlignmentOptions) -> None:
        self._options = options
        self._estimate_m: list[tuple[float, float, float]] = []
        self._reference_m: list[tuple[float, float, float]] = []
        self._next_fit = 1
        self._running = RunningErrors()
        self.alignment: Alignment | None = None
        self.so_far: ErrorSoFar | None = None

    def add(self, estimate_m: tuple[float, float, float], reference_m: tuple[float, float, float]) -> None:
        """One pair more; ``so_far`` is None until the pairs fix the frame."""
        self._estimate_m.append(estimate_m)
        self._reference_m.append(reference_m)
        count = len(self._estimate_m)
        if count >= self._next_fit:
            self._fit()
            self._next_fit = count + max(1, int(GROWTH * count))
        elif self.alignment is not None:
            error_m = self.aligned_m(estimate_m) - reference_m
            self.so_far = self._running.add(float(np.hypot(*error_m[:2])), float(np.linalg.norm(error_m)))

    def aligned_m(self, estimate_m: tuple[float, float, float]) -> Array:
        """A position of the system in the reference's frame, shape (3,), as far as that is known."""
        position_m = np.array(estimate_m)
        return position_m if self.alignment is None else self.alignment.site_from_estimate.apply(position_m[None])[0]

    def _fit(self) -> None:
        pairs = _pairs(np.array(self._estimate_m), np.array(self._reference_m))
        try:
            self.alignment = align(pairs, self._options)
        except DegenerateGeometry:
            self.alignment, self.so_far = None, None
            return
        errors_m = self.alignment.apply(pairs.estimate).positions_m - pairs.reference.positions_m
        self._running, self.so_far = RunningErrors.of(
            np.linalg.norm(errors_m[:, :2], axis=1), np.linalg.norm(errors_m, axis=1)
        )


def _pairs(estimate_m: Array, reference_m: Array) -> Pairs:
    """Pairs without times of their own: their order is enough."""
    order = np.arange(len(estimate_m))
    times_s = order.astype(np.float64)
    return Pairs(Trajectory(times_s, reference_m), Trajectory(times_s, estimate_m), order, len(order))
