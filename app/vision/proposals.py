"""Cheap tests that leave, of all groups of five red blobs, those worth measuring: right sizes, and black between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS
from app.vision.dots import Blobs
from app.vision.homography import PLATE_DOTS_U
from app.vision.kernels.gaps import weigh_groups

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Pixels = npt.NDArray[np.uint8]


@dataclass(frozen=True)
class ProposalOptions:
    """What a group must show at first sight.

    Attributes
    ----------
    depth_ratio_max : float
        Farthest over nearest corner: a plate seen at 75 degrees from twice its width has 2.2; blobs add noise.
    e_offset_u, e_offset_px : float
        How far E may lie from where the corner dots predict it: a part of its radius, and blob noise.
    size_ratio : tuple of float
        Blob radius over predicted radius (geometric mean of the axes): half-peak outlines scatter about 1.
    dark_fraction : float
        A gap is dark when its red lies below this part of the way from the darkest gap to the red dots.
    dark_gaps_min : int
        Dark gaps of 21: some may be covered, or lie in the skirts of white dots on small plates.
    proposals_max : int
        The strongest are measured: far more than a photograph holds targets, to bound what a hostile one costs.
    red_contrast_min : float
        Grey values between red dots and dark gaps, in red: above noise.
    """

    depth_ratio_max: float = 2.5
    e_offset_u: float = 0.5
    e_offset_px: float = 0.8
    size_ratio: tuple[float, float] = (0.45, 1.9)
    dark_fraction: float = 0.6
    dark_gaps_min: int = 15
    proposals_max: int = 2000
    red_contrast_min: float = 16.0


def gap_points_u() -> Array:
    """Plate coordinates, shape (21, 2), of the black farthest from any dot: nine inner gaps, twelve at the border."""
    inner = np.array([(x, y) for y in (-3.0, 0.0, 3.0) for x in (-3.0, 0.0, 3.0)])
    along = [(x, y) for x in (-3.0, 0.0, 3.0) for y in (-5.9, 5.9)]
    return np.concatenate([inner, along, [(y, x) for x, y in along]])


GAPS_U = gap_points_u()
BASE_U = PLATE_DOTS_U[list(BASE_CELLS)]


def promising(bgr: Pixels, blobs: Blobs, groups: Indices, options: ProposalOptions = ProposalOptions()) -> Indices:
    """The groups, shape (G', 5), that pass, strongest first; ``groups`` holds A, B, C, D, E as blob indices."""
    bounds = (
        options.depth_ratio_max,
        options.e_offset_u,
        options.e_offset_px,
        *options.size_ratio,
        options.dark_fraction,
        float(options.dark_gaps_min),
        options.red_contrast_min,
    )
    radii_px = np.sqrt(blobs.semi_axes_px[:, 0] * blobs.semi_axes_px[:, 1])
    contrast = np.empty(len(groups))
    base_px, base_radii_px = (np.ascontiguousarray(part[groups]) for part in (blobs.centres_px, radii_px))
    weigh_groups(np.ascontiguousarray(bgr), base_px, base_radii_px, GAPS_U, bounds, contrast)
    strongest = np.argsort(-contrast, kind="stable")[: options.proposals_max]
    return groups[strongest[contrast[strongest] > 0]]
