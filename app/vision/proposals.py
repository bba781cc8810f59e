"""Cheap tests that leave, of all groups of five red blobs, those worth measuring: right sizes, and black between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS, PLATE_SIDE_U
from app.vision.dots import Blobs, sample_rows
from app.vision.homography import (
    PLATE_DOTS_U,
    apply_homographies,
    image_from_corner_dots,
    local_px_per_u,
)

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Pixels = npt.NDArray[np.uint8]

RED_CHANNEL = 2


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
    """The groups, shape (G', 5), that pass; ``groups`` holds A, B, C, D, E as blob indices."""
    groups = groups[_convex(blobs.centres_px[groups[:, :4]])]
    if not len(groups):
        return groups
    image_from_plate = image_from_corner_dots(blobs.centres_px[groups[:, :4]])
    in_front = _in_front(image_from_plate, options)
    groups, image_from_plate = groups[in_front], image_from_plate[in_front]
    groups = groups[_sizes_agree(image_from_plate, blobs, groups, options)]
    if not len(groups):
        return groups
    contrast = _black_between(bgr, blobs.centres_px[groups], options)
    strongest = np.argsort(-contrast, kind="stable")[: options.proposals_max]
    return groups[strongest[contrast[strongest] > 0]]


def _convex(corners_px: Array) -> npt.NDArray[np.bool_]:
    """Whether A, B, C, D turn clockwise at every corner: five dots in the other order are not a target."""
    side = np.roll(corners_px, -1, axis=1) - corners_px
    following = np.roll(side, -1, axis=1)
    turn = side[..., 0] * following[..., 1] - side[..., 1] * following[..., 0]
    return np.asarray((turn > 0).all(axis=1))


def _in_front(image_from_plate: Array, options: ProposalOptions) -> npt.NDArray[np.bool_]:
    """Whether the whole plate is in front of the camera, and its depth varies as a plate's can."""
    edges_u = PLATE_SIDE_U / 2.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    depth = image_from_plate[:, 2, :2] @ edges_u.T + image_from_plate[:, 2, 2:]
    result: npt.NDArray[np.bool_] = depth.min(axis=1) * options.depth_ratio_max > depth.max(axis=1)
    return result & (depth.min(axis=1) > 0)


def _sizes_agree(
    image_from_plate: Array, blobs: Blobs, groups: Indices, options: ProposalOptions
) -> npt.NDArray[np.bool_]:
    """Whether E is where the corners say, and the blobs are as large as the plate says."""
    px_per_u = local_px_per_u(image_from_plate)
    e_px = apply_homographies(image_from_plate, BASE_U[4:])[:, 0]
    offset_px = np.linalg.norm(e_px - blobs.centres_px[groups[:, 4]], axis=1)
    e_agrees = offset_px < options.e_offset_u * px_per_u + options.e_offset_px
    radius_px = np.sqrt(blobs.semi_axes_px.prod(axis=1))
    ratio = np.median(radius_px[groups], axis=1) / px_per_u
    result: npt.NDArray[np.bool_] = e_agrees & (ratio > options.size_ratio[0]) & (ratio < options.size_ratio[1])
    return result


def _black_between(bgr: Pixels, base_px: Array, options: ProposalOptions) -> Array:
    """Red between the dots and the gaps, shape (G,), grey values; 0 where the gaps are not black."""
    gaps_px = apply_homographies(image_from_corner_dots(base_px[:, :4]), GAPS_U)
    red = sample_rows(bgr, np.concatenate([base_px, gaps_px], axis=1))[..., RED_CHANNEL]
    dots, gaps = red[:, :5], np.sort(red[:, 5:], axis=1)
    lit, black = np.median(dots, axis=1), gaps[:, len(GAPS_U) // 4]
    border = black + options.dark_fraction * (lit - black)
    dark = (gaps < border[:, None]).sum(axis=1)
    contrast = lit - black
    stands = (dark >= options.dark_gaps_min) & (contrast > options.red_contrast_min)
    return np.where(stands, contrast, 0.0)
