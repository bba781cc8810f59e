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
from app.vision.centres import YCC_FROM_BGR, CentreOptions, DotCentres, calibrated_covariances
from app.vision.kernels.pixels import settle_all
from app.vision.kernels.profiles import BLUR_LEVELS, BLUR_STEP_U, EDGE_REACH, EDGE_STEPS, LIGHT_MAX, LIGHT_STEPS
from app.vision.measurement import PlateFits

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Pixels = npt.NDArray[np.uint8]

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
        Farthest pixel from a dot's centre: half-way to a neighbour's edge, and its blur.
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
    reach_u: float = 1.7
    reach_blurs: float = 3.0
    chroma_blur_px: float = 1.0
    chroma_weight: float = 1.5
    step_max_u: float = 0.15
    noise_grey: float = 10.0
    floor_px: float = 0.02
    unseen_factor: float = 1.3


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
    steps = np.empty((len(large), dots.measured.shape[1], 5))
    plates = (np.linalg.inv(fits.image_from_plate[large]), fits.amplitudes[large], fits.planes[large])
    centres_px, measured = np.ascontiguousarray(dots.centres_px[large]), np.ascontiguousarray(dots.measured[large])
    plate_from_image, amplitudes, planes = (np.ascontiguousarray(part) for part in plates)
    tables = (edge_table(), grey_table(), YCC_FROM_BGR, _limits(options))
    settle_all(bgr, (plate_from_image, amplitudes, planes, blur_px), (centres_px, measured), tables, steps)
    return _moved(dots, large, steps, options)


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
    finer = replace(
        centres,
        covariance_floor_px=settling.floor_px,
        covariance_floor_u=0.0,
        unseen_factor=settling.unseen_factor,
    )
    by_samples = calibrated_covariances(dots, image_from_plate, trusted & ~settled, centres)
    by_pixels = calibrated_covariances(dots, image_from_plate, trusted & settled, finer)
    return np.where(settled[:, None, None, None], by_pixels, by_samples)


def _moved(dots: DotCentres, large: npt.NDArray[np.intp], steps: Array, options: SettlingOptions) -> DotCentres:
    u_by_px = np.linalg.inv(dots.px_by_u[large])
    step_u = np.einsum("pdij,pdj->pdi", u_by_px, steps[..., :2])
    xx, xy, yy = np.moveaxis(steps[..., 2:], -1, 0)
    determinant = xx * yy - xy * xy
    believed = dots.measured[large] & (determinant > 0.0) & (np.abs(step_u).max(axis=-1) < options.step_max_u)
    cofactors = np.stack([np.stack([yy, -xy], axis=-1), np.stack([-xy, xx], axis=-1)], axis=-2)
    covariances_px2 = options.noise_grey**2 * cofactors / np.where(determinant > 0.0, determinant, 1.0)[..., None, None]
    centres_px, covariances_u2 = dots.centres_px.copy(), dots.covariances_u2.copy()
    centres_px[large] += np.where(believed[..., None], steps[..., :2], 0.0)
    moved_u2 = u_by_px @ covariances_px2 @ np.swapaxes(u_by_px, -1, -2)
    covariances_u2[large] = np.where(believed[..., None, None], moved_u2, covariances_u2[large])
    return replace(dots, centres_px=centres_px, covariances_u2=covariances_u2)


def _limits(options: SettlingOptions) -> Array:
    reach = [options.reach_u, options.reach_blurs, options.chroma_blur_px]
    return np.array([reach, [1.0, options.chroma_weight, options.chroma_weight]])


@cache
def edge_table() -> Array:
    """Share of a unit disc's light by blur, and by distance from the edge in standard deviations (``edge_profile``).

    Notes
    -----
    The integral of ``template.blurred_disc``, on nodes that resolve each level's kernel; a straight edge's for none.
    """
    from_edge = np.arange(-EDGE_REACH, EDGE_REACH + 0.5 / EDGE_STEPS, 1.0 / EDGE_STEPS)
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE_NODES)
    r, weights = 0.5 * DOT_RADIUS_U * (nodes + 1.0), 0.5 * DOT_RADIUS_U * weights
    table = np.empty((BLUR_LEVELS + 1, len(from_edge)))
    table[0] = ndtr(-from_edge)
    for level in range(1, BLUR_LEVELS + 1):
        blur_u = level * BLUR_STEP_U
        rho = np.maximum(DOT_RADIUS_U + from_edge * blur_u, 0.0)[:, None]
        kernel = r / blur_u**2 * np.exp(-((rho - r) ** 2) / (2.0 * blur_u**2)) * ive(0, rho * r / blur_u**2)
        table[level] = kernel @ weights
    return table


@cache
def grey_table() -> Array:
    """Grey value of linear light in steps, 0 ... 255, by sRGB's curve (IEC 61966-2-1); see ``patches``."""
    linear = np.linspace(0.0, 1.0, int(LIGHT_MAX) * LIGHT_STEPS + 1)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return np.asarray(LIGHT_MAX * coded)
