"""Storeys: whether a system finds the right one, and EvAAL's score, which charges for the wrong one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.trajectories.association import Pairs
from app.trajectories.metrics.errors import Errors
from app.trajectories.trajectory import Array, Trajectory

Floors = npt.NDArray[np.int64]

FLOOR_PENALTY_M = 15.0  # per storey, of the EvAAL and IPIN competitions


@dataclass(frozen=True)
class FloorScore:
    """How well storeys are told.

    Attributes
    ----------
    detection_probability : float
        Share of the pairs on the right storey (ISO/IEC 18305).
    differences : ndarray of int, shape (K,)
        Storey of the estimate - storey of the reference.
    """

    detection_probability: float
    differences: Floors


def floor_score(pairs: Pairs, floor_height_m: float | None = None) -> FloorScore | None:
    """The storeys of aligned pairs; None when either has none and no height of a storey is given.

    Parameters
    ----------
    pairs : Pairs
    floor_height_m : float, optional
        Takes heights to storeys where they were not told: storey 0 begins at z = 0.
    """
    true, told = (_floors(trajectory, floor_height_m) for trajectory in (pairs.reference, pairs.estimate))
    if true is None or told is None:
        return None
    differences = told - true
    return FloorScore(float((differences == 0).mean()), differences)


def _floors(trajectory: Trajectory, floor_height_m: float | None) -> Floors | None:
    if trajectory.floors is not None:
        return trajectory.floors
    if floor_height_m is None:
        return None
    if not floor_height_m > 0:
        raise ValueError(f"floor_height_m must be positive, got {floor_height_m}")
    return np.floor(trajectory.positions_m[:, 2] / floor_height_m).astype(np.int64)


def evaal_errors_m(errors: Errors, floors: FloorScore | None) -> Array:
    """Errors as EvAAL scores them, shape (K,): in the plan, and 15 m for each storey that is wrong.

    Notes
    -----
    Potortì et al., The IPIN 2019 Indoor Localisation Competition, IEEE Access 8, 2020; the score is their third
    quartile (of type 7), ``Summary.quantile_75``.
    """
    penalty_m = 0.0 if floors is None else FLOOR_PENALTY_M * np.abs(floors.differences)
    return errors.horizontal_m + penalty_m
