"""Dots of some targets: how they lie about their middle, and how far two poses see them apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SIGHTED = "Tuple((float64[:, ::1], float64[:, :, ::1], boolean[:, ::1]))"
POSE = "Tuple((float64[:, ::1], float64[::1]))"


@compiled(f"int64({SIGHTED}, boolean[::1], float64[::1], float64[:, ::1])")
def sum_moments(sighted: tuple[Any, ...], chosen: Mask, middle_m: Array, moments_m2: Array) -> int:
    """Middle (3,) and second moments about it (3, 3), written, of the measured dots of some targets; their number.

    Parameters
    ----------
    sighted : tuple of ndarray
        Centres (K, 3), arms (K, 16, 3), which dots are measured (K, 16).
    chosen : ndarray of shape (K,), bool
    """
    centres_m, arms_m, measured = sighted
    count, from_first_m, first_m = 0, np.empty(3), centres_m[np.argmax(chosen)]
    middle_m[:], moments_m2[:] = 0.0, 0.0
    for target in range(len(centres_m)):
        for dot in range(DOT_COUNT if chosen[target] else 0):
            if not measured[target, dot]:
                continue
            count += 1
            for axis in range(3):
                from_first_m[axis] = centres_m[target, axis] + arms_m[target, dot, axis] - first_m[axis]
                middle_m[axis] += from_first_m[axis]
                for other in range(axis + 1):
                    moments_m2[axis, other] += from_first_m[axis] * from_first_m[other]
    for axis in range(3):
        for other in range(axis + 1):
            moments_m2[axis, other] -= middle_m[axis] * middle_m[other] / count
            moments_m2[other, axis] = moments_m2[axis, other]
    for axis in range(3):
        middle_m[axis] = first_m[axis] + middle_m[axis] / count
    return count


@compiled(f"float64({POSE}, float64[::1], float64[::1])")
def _see(pose: tuple[Array, Array], dot_m: Array, image: Array) -> float:
    """A dot's depth, m; its place in the image plane is written."""
    rotation, position_m = pose
    depth_m, image[0], image[1] = 0.0, 0.0, 0.0
    for axis in range(3):
        offset_m = dot_m[axis] - position_m[axis]
        image[0] += offset_m * rotation[axis, 0]
        image[1] += offset_m * rotation[axis, 1]
        depth_m += offset_m * rotation[axis, 2]
    image[0], image[1] = image[0] / depth_m, image[1] / depth_m
    return depth_m


@compiled(f"boolean({SIGHTED}, boolean[::1], UniTuple({POSE}, 2), float64)")
def see_alike(sighted: tuple[Any, ...], chosen: Mask, poses: tuple[Any, ...], most_squares: float) -> bool:
    """Whether two poses see the measured dots of some targets before them, and in about the same places.

    ``most_squares`` is the greatest sum of squared distances in the image plane.
    """
    centres_m, arms_m, measured = sighted
    dot_m, one, other, squares = np.empty(3), np.empty(2), np.empty(2), 0.0
    for target in range(len(centres_m)):
        for dot in range(DOT_COUNT if chosen[target] else 0):
            if not measured[target, dot]:
                continue
            for axis in range(3):
                dot_m[axis] = centres_m[target, axis] + arms_m[target, dot, axis]
            if _see(poses[0], dot_m, one) <= 0.0 or _see(poses[1], dot_m, other) <= 0.0:
                return False
            squares += (one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2
        if squares > most_squares:
            return False
    return True
