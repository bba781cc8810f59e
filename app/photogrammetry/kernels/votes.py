"""Where targets are seen, how large, and how far from where a proposed pose would see them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]


@compiled(
    "void(Tuple((float64[:, ::1], float64[:, :, ::1], float64[:, :, ::1], boolean[:, ::1])), "
    "Tuple((float64[:, ::1], float64[:, ::1], float64[::1])))"
)
def find_middles(sighted: tuple[Any, ...], written: tuple[Array, ...]) -> None:
    """Middles of the measured dots, in the site and in the image, and how far the image's dots lie from theirs.

    Parameters
    ----------
    sighted : tuple of ndarray
        Centres (K, 3), arms (K, 16, 3), observed dots (K, 16, 2), which are measured (K, 16).
    written : tuple of ndarray
        Middles in the site (K, 3) and in the image (K, 2); sums of squared distances in the image (K,), px^2.
    """
    centres_m, arms_m, observed_px, measured = sighted
    middles_m, middles_px, sizes_px2 = written
    for target in range(len(centres_m)):
        count = max(1.0, float(np.count_nonzero(measured[target])))
        middles_m[target], middles_px[target], sizes_px2[target] = centres_m[target], 0.0, 0.0
        for dot in range(DOT_COUNT):
            if measured[target, dot]:
                for axis in range(3):
                    middles_m[target, axis] += arms_m[target, dot, axis] / count
                for axis in range(2):
                    middles_px[target, axis] += observed_px[target, dot, axis] / count
        for dot in range(DOT_COUNT):
            if measured[target, dot]:
                for axis in range(2):
                    sizes_px2[target] += (observed_px[target, dot, axis] - middles_px[target, axis]) ** 2


@compiled(
    "void(Tuple((float64[:, ::1], float64[:, :, ::1], float64[:, ::1])), "
    "Tuple((float64[:, :, ::1], float64[:, ::1])), float64[:, ::1])"
)
def measure_misses(seen: tuple[Array, ...], proposals: tuple[Array, ...], misses: Array) -> None:
    """How far each target's middle stands from where each proposal sees it, normalised units, (H, K), written.

    Infinite where the target would stand behind the camera or show it its back.

    Parameters
    ----------
    seen : tuple of ndarray
        Middles in the site (K, 3), rotations ``site_from_target`` (K, 3, 3), middles in the image plane (K, 2).
    proposals : tuple of ndarray
        Rotations (H, 3, 3) and positions (H, 3) ``site_from_cam``.
    """
    middles_m, target_rotations, normalised = seen
    rotations, positions_m = proposals
    offset_m, cam_m = np.empty(3), np.empty(3)
    for proposal in range(len(rotations)):
        rotation = rotations[proposal]
        for target in range(len(middles_m)):
            facing = 0.0
            for axis in range(3):
                offset_m[axis] = middles_m[target, axis] - positions_m[proposal, axis]
                facing += offset_m[axis] * target_rotations[target, axis, 2]
            for axis in range(3):
                cam_m[axis] = (
                    offset_m[0] * rotation[0, axis] + offset_m[1] * rotation[1, axis] + offset_m[2] * rotation[2, axis]
                )
            misses[proposal, target] = np.inf
            if cam_m[2] > 0.0 and facing < 0.0:
                x, y = cam_m[0] / cam_m[2] - normalised[target, 0], cam_m[1] / cam_m[2] - normalised[target, 1]
                misses[proposal, target] = np.sqrt(x * x + y * y)
