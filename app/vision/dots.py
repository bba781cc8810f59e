"""Red blobs: cheap proposals for base dots from colour alone.

Colour proposes; the plate fit localises later, so a centre here need only be good to a fraction of a dot.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
import numpy.typing as npt

from app.vision.kernels.ellipses import fit_ellipses
from app.vision.kernels.labels import label_blobs
from app.vision.kernels.peaks import TILE_COLUMNS, TILE_ROWS
from app.vision.kernels.redness import measure_redness, shares_of
from app.vision.kernels.rings import measure_contrast
from app.vision.kernels.whites import brighter_than

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]


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
        Least excess over that of a few pixels' average, in grey values of 255: above the noise of dark pixels.
    ring_axes, ring_points, ring_fraction : float, int, float
        On a ring of this many major semi-axes most of the points have lost the red: the gap between dots reaches from
        1 to 2 radii.
    area_px2 : tuple of int
        Least and greatest number of a blob's pixels: a dot of 2 px by 4 px, and one of 250 px.
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
    ring_axes: float = 1.7
    ring_points: int = 8
    ring_fraction: float = 0.35
    area_px2: tuple[int, int] = (6, 50_000)
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

    def followed_by(self, centres_px: Array, semi_axes_px: Array) -> Blobs:
        """These and, behind them, dots that were not seen but must be there: shapes (M, 2) and (M, 2)."""
        return Blobs(np.concatenate([self.centres_px, centres_px]), np.concatenate([self.semi_axes_px, semi_axes_px]))

    def __len__(self) -> int:
        return len(self.centres_px)


def find_red_blobs(bgr: Pixels, options: DotOptions = DotOptions()) -> Blobs:
    """Blobs of red pixels in a photograph of shape (H, W, 3)."""
    redness, hot = _redness(bgr, options)
    moments = label_blobs(redness, hot, np.uint8(options.red_floor))
    centres_px, semi_axes_px = np.empty((2, len(moments), 2))
    least, most = options.area_px2
    kept = fit_ellipses(moments, (float(least), float(most), options.axis_ratio_max), centres_px, semi_axes_px)
    centres_px, semi_axes_px = centres_px[:kept], semi_axes_px[:kept]
    contrast = np.empty(kept)
    reach_px = options.ring_axes * semi_axes_px[:, 0]
    measure_contrast(redness, centres_px, reach_px, unit_circle(options.ring_points), options.ring_fraction, contrast)
    strongest = np.argsort(-contrast, kind="stable")[: options.blobs_max]
    strongest = strongest[contrast[strongest] > 0]
    return Blobs(centres_px[strongest], semi_axes_px[strongest])


def _redness(bgr: Pixels, options: DotOptions) -> tuple[Pixels, Pixels]:
    """How much redder than grey each pixel is, shape (H, W), and which tiles hold some, shape (H / 16, W / 64)."""
    height, width = bgr.shape[:2]
    redness = np.empty((height, width), dtype=np.uint8)
    hot = np.empty((-(-height // TILE_ROWS), -(-width // TILE_COLUMNS)), dtype=np.uint8)
    gain, ratio = (shares_of(factor) for factor in (_red_gain(bgr, options), options.red_ratio))
    measure_redness(np.ascontiguousarray(bgr), gain, ratio, np.uint8(options.red_floor), redness, hot)
    return redness, hot


@cache
def unit_circle(count: int) -> Array:
    """Points of a unit circle, shape (count, 2)."""
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


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
    blue, green, red = brighter_than(bgr, options.sparse_step_px, options.white_percentile / 100.0)
    return float(np.clip(max(blue, green, 1.0) / max(red, 1.0), *options.red_gain))
