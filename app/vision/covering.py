"""Hidden or missing: a base dot that is not seen is forgiven only where something covers its place.

A plate of wrong structure shows black around the place, as around every dot; what stands before a plate reaches beyond
the dot and is hardly as black. Something just as black is taken for the plate: better a target lost than a wrong one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS
from app.vision.dots import sample_rows
from app.vision.homography import PLATE_DOTS_U, apply_homographies
from app.vision.kernels.inkwell import RED
from app.vision.measurement import PlateFits
from app.vision.patches import LINEAR_FROM_CODED

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

BASE = list(BASE_CELLS)


@dataclass(frozen=True)
class CoveringOptions:
    """When the place of a base dot counts as covered.

    Attributes
    ----------
    ring_u : float
        Radius of the ring of black that is looked at: half-way between a dot's edge (1 u) and its neighbours' (2 u).
    ring_points : int
        Points on it.
    off_black_min : float
        Median distance of the ring's colours from the plate's black over the plate's red, linear light: up to 0.1 in
        plain view, even with bright dots blurred into it; 0.35 under something brown.
    """

    ring_u: float = 1.5
    ring_points: int = 16
    off_black_min: float = 0.2


def covered_base_dots(
    bgr: Pixels, fits: PlateFits, image_from_plate: Array, options: CoveringOptions = CoveringOptions()
) -> npt.NDArray[np.bool_]:
    """Which base dots are not surrounded by the plate's black, shape (P, 5).

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    fits : PlateFits
        Tell the plates' black and red.
    image_from_plate : ndarray of shape (P, 3, 3)
        Homographies through the dots that are seen: those of the first look may miss a hidden corner by a dot's size.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, options.ring_points, endpoint=False)
    ring_u = options.ring_u * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points_u = (PLATE_DOTS_U[BASE, None] + ring_u).reshape(-1, 2)
    coded = sample_rows(bgr, apply_homographies(image_from_plate, points_u))
    linear = LINEAR_FROM_CODED[np.rint(coded).astype(np.intp)]
    off_black = np.abs(linear - fits.background[:, None]).max(axis=2).reshape(len(linear), len(BASE), -1)
    red = np.median(fits.amplitudes[:, BASE, RED], axis=1)
    result: npt.NDArray[np.bool_] = np.median(off_black, axis=2) > options.off_black_min * red[:, None]
    return result
