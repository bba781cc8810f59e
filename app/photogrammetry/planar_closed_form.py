"""Both poses of a flat target in closed form, for many targets (``kernels/planar.py`` says how)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.kernels.planar import solve_planar_poses

Array = npt.NDArray[np.float64]


def weighted_mean(values: Array, weights: Array) -> Array:
    """Means over the dots, shape (K, D), of values of shape (K, N, D) under weights of shape (K, N)."""
    return np.asarray((weights[:, None] @ values)[:, 0] / weights.sum(axis=-1)[:, None])


def closed_form_poses(plane_m: Array, normalised: Array, weights: Array) -> tuple[Array, Array]:
    """Rotations, shape (K, 2, 3, 3), and translations, shape (K, 2, 3), ``cam_from_target`` of both solutions.

    Parameters
    ----------
    plane_m, normalised : ndarray of shape (K, N, 2)
        Dots in the target's plane (m) and their image-plane coordinates.
    weights : ndarray of shape (K, N)
        1 for a measured dot, 0 for another; the measured dots of each target are not collinear.
    """
    rotations, translations_m = np.empty((len(plane_m), 2, 3, 3)), np.empty((len(plane_m), 2, 3))
    plane_m, normalised, weights = (np.ascontiguousarray(part) for part in (plane_m, normalised, weights))
    solve_planar_poses(plane_m, normalised, weights, rotations, translations_m)
    return rotations, translations_m
