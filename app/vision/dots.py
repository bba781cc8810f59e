"""Red blobs: cheap proposals for base dots from colour alone.

Colour proposes; the plate fit localises later, so a centre here need only be good to a fraction of a dot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

STRIP_ROWS = 256  # 1.5 MB of a 1080p photograph, 3 MB of 12 megapixels: what stays near a processor core


@dataclass(frozen=True)
class DotOptions:
    """Which pixels are red, and which blobs may be dots.

    Attributes
    ----------
    red_ratio : float
        Red counts over this multiple of the greater of green and blue, after white balance. The printed red has 5.6 in
        sRGB; blur and chroma subsampling bring small dots down to 2.4, a reflection on a laminated plate to 1.4.
    white_percentile : float
        Where each channel stands in for white; the median of bright rooms, and under the lamps of dark ones.
    red_gain : tuple of float
        Limits of the white balance: a red wall must not pass for a red lamp.
    sparse_step_px : int
        White is estimated on every n-th row and column.
    red_floor : int
        Least excess over that, in grey values of 255: above the noise of dark pixels.
    smooth_px : int
        Box that averages the excess: pixel noise must not break a dot or make one.
    peak_window_px : int
        A dot ends where its excess falls to half the peak within this width, which holds a small dot and the gap
        beside it: the edge of a blurred disc, and what parts dots whose skirts touch.
    ring_axes, ring_points, ring_fraction : float, int, float
        On a ring of this many major semi-axes most of the points have lost the red: the gap between dots reaches from
        1 to 2 radii.
    contour_points_min, contour_points_max : int
        Length of a blob's outline, px. The least is a dot of 2 px by 4 px; the greatest one of 250 px.
    blobs_max : int
        The strongest are kept: 6,000 make 1,200 targets, and bound the time that a hostile picture can take.
    axis_ratio_max : float
        Longest over shortest axis: a circle seen at 75 degrees has 3.9; small blobs scatter.
    """

    red_ratio: float = 1.2
    white_percentile: float = 80.0
    red_gain: tuple[float, float] = (0.6, 1.3)
    sparse_step_px: int = 24
    red_floor: int = 12
    smooth_px: int = 3
    peak_window_px: int = 7
    ring_axes: float = 1.7
    ring_points: int = 8
    ring_fraction: float = 0.35
    contour_points_min: int = 7
    contour_points_max: int = 800
    blobs_max: int = 6000
    axis_ratio_max: float = 6.0


@dataclass(frozen=True)
class Blobs:
    """Red blobs of one photograph.

    Attributes
    ----------
    centres_px : ndarray of shape (N, 2)
    semi_axes_px : ndarray of shape (N, 2)
        Major and minor semi-axis of the ellipse with the outline's second moments.
    """

    centres_px: Array
    semi_axes_px: Array

    def __len__(self) -> int:
        return len(self.centres_px)


def find_red_blobs(bgr: Pixels, options: DotOptions = DotOptions()) -> Blobs:
    """Blobs of red pixels in a photograph of shape (H, W, 3)."""
    excess, mask = _red_pictures(bgr, options)
    outlines, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    least, most = options.contour_points_min, options.contour_points_max
    outlines = [outline for outline in outlines if least <= len(outline) <= most]
    if not outlines:
        return Blobs(np.empty((0, 2)), np.empty((0, 2)))
    centres_px, semi_axes_px = _ellipses(outlines)
    keep = semi_axes_px[:, 0] <= options.axis_ratio_max * semi_axes_px[:, 1]
    contrast = _ring_contrast(excess, centres_px, semi_axes_px, options)
    kept = np.flatnonzero(keep & (contrast > 0))
    strongest = kept[np.argsort(-contrast[kept], kind="stable")[: options.blobs_max]]
    return Blobs(centres_px[strongest], semi_axes_px[strongest])


def _red_pictures(bgr: Pixels, options: DotOptions) -> tuple[Pixels, Pixels]:
    """How much redder than grey each pixel is, and 255 where it belongs to the upper half of its own peak; both (H, W).

    Strip by strip, so that each step finds the last one's result in the processor's cache.
    """
    gain = _red_gain(bgr, options)
    height = len(bgr)
    excess, mask = np.empty((2, *bgr.shape[:2]), dtype=np.uint8)
    halo = options.smooth_px // 2 + options.peak_window_px // 2
    for first in range(0, height, STRIP_ROWS):
        last = min(first + STRIP_ROWS, height)
        above, below = max(first - halo, 0), min(last + halo, height)
        strip = _red_excess(bgr[above:below], gain, options)
        inner = slice(first - above, last - above)
        excess[first:last] = strip[inner]
        mask[first:last] = _upper_half(strip, options)[inner]
    return excess, mask


def _red_excess(bgr: Pixels, gain: float, options: DotOptions) -> Pixels:
    """How much redder than grey each pixel is, shape (H, W); 0 for all that is not red."""
    blue, green, red = cv2.split(bgr)
    # Saturating arithmetic: all that is not red is 0.
    excess = cv2.addWeighted(red, gain, cv2.max(green, blue), -options.red_ratio, 0.0)
    return np.asarray(cv2.blur(excess, (options.smooth_px, options.smooth_px)), dtype=np.uint8)


def _upper_half(excess: Pixels, options: DotOptions) -> Pixels:
    """255 where a pixel belongs to the upper half of its own peak, shape (H, W)."""
    window = np.ones((options.peak_window_px, options.peak_window_px), dtype=np.uint8)
    # More than half the peak: more than what it lacks to the peak. OpenCV does this at the speed of memory.
    lacking = cv2.subtract(cv2.dilate(excess, window), excess)
    floor = np.full(excess.shape, options.red_floor, dtype=np.uint8)
    return np.asarray(cv2.compare(excess, cv2.max(lacking, floor), cv2.CMP_GT), dtype=np.uint8)


def _ring_contrast(excess: Pixels, centres_px: Array, semi_axes_px: Array, options: DotOptions) -> Array:
    """By how much the red ends around each blob, shape (N,), grey values; not positive where it hardly does.

    It ends on a plate's black; the grains of a brownish surface stand on more of the same.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, options.ring_points, endpoint=False)
    circle = np.vstack([np.zeros((1, 2)), np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    points_px = centres_px[:, None] + options.ring_axes * semi_axes_px[:, None, :1] * circle
    values = sample_rows(excess, points_px)
    result: Array = options.ring_fraction * values[:, 0] - np.median(values[:, 1:], axis=1)
    return result


def sample_rows(pixels: Pixels, points_px: Array) -> Array:
    """Bilinear samples, shape (N, M) or (N, M, channels), at points of shape (N, M, 2), in blocks OpenCV can take."""
    rows_max = 30_000
    blocks = [
        cv2.remap(pixels, block[..., 0], block[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        for block in np.array_split(points_px.astype(np.float32), 1 + len(points_px) // rows_max)
    ]
    return np.concatenate(blocks).astype(np.float64)


def _red_gain(bgr: Pixels, options: DotOptions) -> float:
    """What takes the photograph's white in red to its green and blue (white patch on a sparse grid)."""
    sparse = bgr[:: options.sparse_step_px, :: options.sparse_step_px].reshape(-1, 3)
    rank = int(options.white_percentile / 100.0 * (len(sparse) - 1))
    blue, green, red = np.partition(sparse, rank, axis=0)[rank].astype(np.float64)
    return float(np.clip(max(blue, green, 1.0) / max(red, 1.0), *options.red_gain))


def _ellipses(outlines: Sequence[npt.NDArray[Any]]) -> tuple[Array, Array]:
    """Centres and semi-axes from the moments of the outlines' points, all at once."""
    counts = np.array([len(outline) for outline in outlines])
    points_px = np.concatenate(outlines).reshape(-1, 2).astype(np.float64)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    centres_px = np.add.reduceat(points_px, starts) / counts[:, None]
    offset_px = points_px - np.repeat(centres_px, counts, axis=0)
    products = np.stack([offset_px[:, 0] ** 2, offset_px[:, 1] ** 2, offset_px[:, 0] * offset_px[:, 1]], axis=1)
    xx, yy, xy = (np.add.reduceat(products, starts) / counts[:, None]).T
    mean, spread = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    # Points on an ellipse have a variance of half its squared semi-axis; pixels reach half a pixel past their centres.
    semi_axes_px = np.sqrt(2.0 * np.maximum(np.stack([mean + spread, mean - spread], axis=1), 0.0)) + 0.5
    return centres_px, semi_axes_px
