"""How far a target must move during a survey to be found: its least detectable displacement.

Source: Baarda, A testing procedure for use in geodetic networks, 1968: what a test cannot see the result may contain.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.split_targets import SplitOptions
from app.photogrammetry.target_pulls import TargetPulls

Array = npt.NDArray[np.float64]

POSITION = slice(0, 3)


def least_detectable_m(pulls: TargetPulls, target_count: int, options: SplitOptions) -> float:
    """Least displacement that is found of a target, metres, in whatever direction shows it worst.

    Parameters
    ----------
    pulls : TargetPulls
    target_count : int
        Targets of the survey that the test looks at.
    options : SplitOptions
        Of the test that is to find it.

    Notes
    -----
    One half of the sightings shows the target where it was, the other d farther. Then the test's squares are
    non-central chi-square distributed by d' N d, N the information of that half on a step: little where its photographs
    follow the target. The halves are taken in the order of the photographs and by turns, d along N's weakest
    direction, and the weaker of both counts.
    """
    weakest = min(_weakest(pulls, half) for half in _halves(len(pulls.rows)))
    squares = options.found_from(len(pulls.rows), target_count)
    # Rounding alone may be left where the photographs follow every step of the target.
    return float(np.sqrt(squares / weakest)) if weakest > 0.0 else np.inf


def _halves(count: int) -> tuple[slice, slice]:
    """Sightings of the second place: the later ones, and every other one."""
    return slice(count // 2, None), slice(None, None, 2)


def _weakest(pulls: TargetPulls, half: slice) -> float:
    """Information on a displacement of some sightings against the others in its weakest direction, per square metre."""
    information = pulls.information[half, POSITION, half, POSITION].sum(axis=(0, 2))
    return float(np.linalg.eigvalsh(information)[0])
