"""The relative pose error (RPE): how far the motion over a stretch differs from the reference's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.trajectories.association import Pairs
from app.trajectories.metrics.absolute_pose_error import Part, error_of_motion, matrices_of, relative_motion
from app.trajectories.trajectory import Array

Unit = Literal["frames", "metres", "seconds"]
Rows = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Stretch:
    """The stretches that are compared.

    Attributes
    ----------
    delta : float
        Length, in ``unit``; frames are whole.
    unit : {"frames", "metres", "seconds"}
        Metres along the reference's path.
    all_pairs : bool
        From every pose; else one stretch after the other.
    """

    delta: float = 1.0
    unit: Unit = "frames"
    all_pairs: bool = False

    def __post_init__(self) -> None:
        if not self.delta > 0:
            raise ValueError(f"delta must be positive, got {self.delta}")
        if self.unit == "frames" and self.delta != int(self.delta):
            raise ValueError(f"a delta in frames is whole, got {self.delta}")


@dataclass(frozen=True)
class RelativeErrors:
    """RPE of M stretches.

    Attributes
    ----------
    starts, ends : ndarray of int, shape (M,)
        Rows of the pairs.
    values : ndarray of shape (M,)
    """

    starts: Rows
    ends: Rows
    values: Array


def relative_pose_errors(pairs: Pairs, part: Part = "trans", stretch: Stretch | None = None) -> RelativeErrors:
    """RPE of each stretch.

    Raises
    ------
    InvalidInput
        When orientations are missing, or the pairs are shorter than one stretch.

    Notes
    -----
    Sturm et al., IROS 2012, equation 1: ``E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j)``. Consecutive stretches and those counted
    in frames are chosen as the tool evo chooses them, so that the numbers are the same.
    """
    stretch = stretch or Stretch()
    starts, ends = stretches_of(pairs, stretch)
    if len(starts) == 0:
        raise InvalidInput(
            f"the pairs are shorter than one stretch of {stretch.delta:g} {stretch.unit}: take a shorter"
        )
    return RelativeErrors(starts, ends, error_of_motion(motion_errors(pairs, starts, ends), part))


def stretches_of(pairs: Pairs, stretch: Stretch) -> tuple[Rows, Rows]:
    """Rows of the first and the last pair of each stretch, shape (M,); none when the pairs are shorter than one."""
    return _stretches(_progress(pairs, stretch.unit), stretch)


def motion_errors(pairs: Pairs, starts: Rows, ends: Rows) -> Array:
    """``E`` of each stretch, shape (M, 4, 4): what the estimate's motion has beyond the reference's."""
    true, estimated = matrices_of(pairs.reference), matrices_of(pairs.estimate)
    true_motion = relative_motion(true[starts], true[ends])
    return relative_motion(true_motion, relative_motion(estimated[starts], estimated[ends]))


def _progress(pairs: Pairs, unit: Unit) -> Array:
    """How far each pair is from the first, shape (K,), in the unit."""
    if unit == "frames":
        return np.arange(len(pairs), dtype=np.float64)
    if unit == "seconds":
        return pairs.reference.times_s - pairs.reference.times_s[0]
    steps_m = np.linalg.norm(np.diff(pairs.reference.positions_m, axis=0), axis=1)
    return np.append(0.0, np.cumsum(steps_m))


def _stretches(progress: Array, stretch: Stretch) -> tuple[Rows, Rows]:
    """First and last rows of the stretches: each ends at the first pose that is a delta or more ahead."""
    ends = np.searchsorted(progress, progress + stretch.delta, side="left")
    if stretch.all_pairs:
        starts = np.flatnonzero(ends < len(progress))
        return starts, ends[starts]
    chain = [0]
    while ends[chain[-1]] < len(progress):
        chain.append(int(ends[chain[-1]]))
    rows = np.array(chain, dtype=np.intp)
    return rows[:-1], rows[1:]
