"""The last step of a dot's centre: least squares on every pixel about its edge, for dots large enough to have many.

The plate's linear model looks at samples some pixels apart: enough to find, judge and read a plate, and for small dots
all there is. About larger dots stand many more pixels than samples. Here they all count, as grey values, in which
noise is much the same in bright and dark, under a blur that is round in the picture and not on the slanted plate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.special import ive, ndtr

from app.targets.layout import DOT_RADIUS_U
from app.vision.centres import YCC_FROM_BGR, CentreOptions, DotCentres, calibrate_covariances
from app.vision.kernels.profiles import BLUR_LEVELS, BLUR_STEP_U, EDGE_REACH, EDGE_STEPS, LIGHT_MAX
from app.vision.kernels.settling import settle_all
from app.vision.measurement import PlateFits

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Array32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

LEVELS_PER_INTEGRAL = 3
CURVE_BEGINS, CURVE_STRAIGHT = 0.0031308, 12.92  # sRGB's line in the dark, of light 0 ... 1, and its slope
CURVE_PLACES = 1000
QUADRATURE_NODES = 400  # over a radius: a blur of one level is resolved by a dozen


@dataclass(frozen=True)
class SettlingOptions:
    """Which dots are settled, and how.

    Attributes
    ----------
    px_per_u_min : float
        Least size of a plate, so dots of 6 px diameter and more: below, pixels gain nothing over samples
        (``benchmarks/centres.py``).
    reach_u : float
        Farthest pixel from a dot's centre: up to 1.7 u nothing is gained by more of them, from 1.3 u on something is
        lost (``benchmarks/centres.py``).
    reach_blurs : float
        Farthest pixel from a dot's edge, standard deviations of the blur.
    chroma_blur_px : float
        What JPEG adds to the blur of chroma, which is stored at half the resolution: 1 px by its box and triangle.
        Only widens the reach: noise is blurred alike, so that a sharp template is nearly
        the best filter.
    chroma_weight : float
        Information of a chroma's pixel over luma's.
    step_max_u : float
        Farthest step that is believed: the linear model errs by 0.02 u.
    noise_grey : float
        Noise of a pixel that covariances start from, before the photograph's plates have spoken: a dim room.
    floor_px : float
        Errors that no noise estimate sees (light that the model lacks, interpolation of chroma): white dots, which
        noise moves least, err by so much more.
    unseen_factor : float
        As of ``CentreOptions``.
    """

    px_per_u_min: float = 3.0
    reach_u: float = 1.4
    reach_blurs: float = 3.0
    chroma_blur_px: float = 1.0
    chroma_weight: float = 1.5
    step_max_u: float = 0.15
    noise_grey: float = 10.0
    floor_px: float = 0.02
    unseen_factor: float = 1.3

    def finer(self, centres: CentreOptions) -> CentreOptions:
        """How covariances of settled dots are scaled."""
        floors = {"covariance_floor_px": self.floor_px, "covariance_floor_u": 0.0}
        return replace(centres, **floors, unseen_factor=self.unseen_factor)


def settle_dots(
    bgr: Pixels,
    fits: PlateFits,
    dots: DotCentres,
    blur_px: float,
    options: SettlingOptions = SettlingOptions(),
) -> DotCentres:
    """The dots with those of large plates moved to where their pixels put them, with covariances to suit.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    fits : PlateFits
        Tell the light of dots, black and paper.
    dots : DotCentres
        As the same fits have placed them: within a fifth of a blur.
    blur_px : float
        Standard deviation of the photograph's blur.
    """
    large = np.flatnonzero(settled_plates(fits, options))
    if not len(large):
        return dots
    image_from_plate, amplitudes = np.ascontiguousarray(fits.image_from_plate), np.ascontiguousarray(fits.amplitudes)
    plates = (image_from_plate, amplitudes, np.ascontiguousarray(fits.planes), blur_px)
    tables = (edge_table(), grey_curve(), YCC_FROM_BGR.astype(np.float32))
    moved = replace(dots, centres_px=np.array(dots.centres_px), covariances_u2=np.array(dots.covariances_u2))
    measured = np.ascontiguousarray(dots.measured)
    written = (measured, moved.centres_px, moved.covariances_u2)
    settle_all(bgr, large, plates, (tables, _limits(options)), written)
    return moved


def settled_plates(fits: PlateFits, options: SettlingOptions = SettlingOptions()) -> Mask:
    """Which plates are large enough, shape (P,)."""
    result: Mask = fits.px_per_u >= options.px_per_u_min
    return result


def settled_covariances(
    dots: DotCentres,
    image_from_plate: Array,
    trusted: Mask,
    settled: Mask,
    options: tuple[CentreOptions, SettlingOptions],
) -> Array:
    """Calibrated covariances, shape (P, 16, 2, 2), px^2; settled plates and the others speak for their own kind."""
    centres, settling = options
    covariances_px2 = np.empty(dots.covariances_u2.shape)
    by_samples, by_pixels = (~settled, trusted & ~settled), (settled, trusted & settled)
    calibrate_covariances(dots, image_from_plate, by_samples, centres, covariances_px2)
    if settled.any():
        calibrate_covariances(dots, image_from_plate, by_pixels, settling.finer(centres), covariances_px2)
    return covariances_px2


def _limits(options: SettlingOptions) -> Array:
    reach = [options.reach_u, options.reach_blurs, options.chroma_blur_px]
    weights = [1.0, options.chroma_weight, options.chroma_weight]
    return np.array([reach, weights, [options.step_max_u, options.noise_grey, 0.0]])


@cache
def edge_table() -> Array32:
    """Share of a unit disc's light by blur, and by distance from the edge in standard deviations (``edge_profiles``).

    Notes
    -----
    The integral of ``template.blurred_disc``, on nodes that resolve each level's kernel; a straight edge's for none.
    Integrals are taken for every third level only: between them, profiles of a standard deviation's scale are linear.
    """
    from_edge = np.arange(-EDGE_REACH, EDGE_REACH + 0.5 / EDGE_STEPS, 1.0 / EDGE_STEPS)
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE_NODES)
    r, weights = 0.5 * DOT_RADIUS_U * (nodes + 1.0), 0.5 * DOT_RADIUS_U * weights
    coarse = np.empty((BLUR_LEVELS // LEVELS_PER_INTEGRAL + 1, len(from_edge)))
    coarse[0] = ndtr(-from_edge)
    for row in range(1, len(coarse)):
        blur_u = row * LEVELS_PER_INTEGRAL * BLUR_STEP_U
        rho = np.maximum(DOT_RADIUS_U + from_edge * blur_u, 0.0)[:, None]
        kernel = r / blur_u**2 * np.exp(-((rho - r) ** 2) / (2.0 * blur_u**2)) * ive(0, rho * r / blur_u**2)
        coarse[row] = kernel @ weights
    rows = np.arange(BLUR_LEVELS + 1) / LEVELS_PER_INTEGRAL
    lower = np.minimum(rows.astype(np.intp), len(coarse) - 2)
    table = coarse[lower] + (rows - lower)[:, None] * (coarse[lower + 1] - coarse[lower])
    growth = np.diff(table, axis=1, append=table[:, -1:])
    return np.stack([table, growth], axis=-1).reshape(-1, 2).astype(np.float32)


@cache
def grey_curve() -> Array32:
    """Of grey values by linear light, both 0 ... 255, as ``grey_values`` takes it: sRGB's (IEC 61966-2-1; ``patches``).

    Notes
    -----
    The curve's power of 1 / 2.4 is a sum of roots to 0.01 of a grey value, fitted at places even in the eighth root.
    """
    roots = np.linspace(CURVE_BEGINS**0.125, 1.0, CURVE_PLACES)
    bent = LIGHT_MAX * roots**8
    grey = LIGHT_MAX * (1.055 * roots ** (8.0 / 2.4) - 0.055)
    terms = np.column_stack([bent**0.5, bent**0.25, bent**0.125, bent, np.ones(CURVE_PLACES)])
    factors = np.linalg.lstsq(terms, grey)[0]
    return np.array([*factors, LIGHT_MAX * CURVE_BEGINS, CURVE_STRAIGHT], dtype=np.float32)
