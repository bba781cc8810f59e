"""Fit the plate template to many plates at once: colours and places of all sixteen dots from the pixels."""

from __future__ import annotations

from dataclasses import dataclass, fields

import cv2
import numpy as np
import numpy.typing as npt

from app.targets.layout import DOT_COUNT
from app.vision.homography import PLATE_DOTS_U, area_scales, homography_jacobians
from app.vision.template import (
    BACKGROUND,
    COEFFICIENTS,
    PER_DOT,
    PatchGrid,
    blur_level,
    plate_template,
)

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

CHANNELS = 3
CENTRE_U = np.zeros((1, 2))


def linear_from_coded() -> Array32:
    """Linear light, 0 ... 255, of sRGB-coded grey values: blur is linear in light, and so are ink and illumination.

    Phones' tone curves differ from sRGB's, but all of them widen bright dots on black, which this undoes.
    """
    coded = np.arange(256) / 255.0
    linear = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    return (255.0 * linear).astype(np.float32)


LINEAR_FROM_CODED = linear_from_coded()


@dataclass(frozen=True)
class Pyramid:
    """A photograph at full and halved sizes, so that a patch's samples stand 1-2 px apart at any plate size.

    Attributes
    ----------
    levels : tuple of ndarray
        ``levels[k]`` has every pixel averaged over 2^k x 2^k.
    """

    levels: tuple[Pixels, ...]

    @classmethod
    def of(cls, bgr: Pixels, count: int) -> Pyramid:
        """Build ``count`` levels, or as many as leave a pixel."""
        levels = [bgr]
        while len(levels) < count and min(levels[-1].shape[:2]) >= 2:
            # Whole blocks of 2 x 2 only: an odd last row or column would shift the grid.
            even = levels[-1][: levels[-1].shape[0] // 2 * 2, : levels[-1].shape[1] // 2 * 2]
            half = cv2.resize(even, (even.shape[1] // 2, even.shape[0] // 2), interpolation=cv2.INTER_AREA)
            levels.append(np.asarray(half, dtype=np.uint8))
        return cls(tuple(levels))

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the photograph."""
        return self.levels[0].shape[1], self.levels[0].shape[0]


@dataclass(frozen=True)
class PlateFits:
    """Template fits of P plates.

    Attributes
    ----------
    image_from_plate : ndarray of shape (P, 3, 3)
        The homographies the patches were sampled with.
    px_per_u : ndarray of shape (P,)
        Local scale at the plate's centre: the square root of the area of a square u.
    amplitudes : ndarray of shape (P, 16, 3)
        Each dot's blue, green, red above the background, linear light of 0 ... 255.
    slopes : ndarray of shape (P, 16, 3, 2)
        The derivative coefficients per channel, linear light per u.
    background : ndarray of shape (P, 3)
        Blue, green, red of the plate's black.
    residual_rms : ndarray of shape (P,)
        Root mean square of samples minus model, over all channels.
    spread_rms : ndarray of shape (P,)
        Root mean square of the samples about each channel's mean: what a fit that explains nothing would leave.
    offset_cofactors : ndarray of shape (P, 16, 2, 2)
        Cofactors of the derivative coefficients.
    """

    image_from_plate: Array
    px_per_u: Array
    amplitudes: Array
    slopes: Array
    background: Array
    residual_rms: Array
    spread_rms: Array
    offset_cofactors: Array

    def select(self, chosen: npt.NDArray[np.intp]) -> PlateFits:
        """The fits of some plates."""
        return PlateFits(*(getattr(self, part.name)[chosen] for part in fields(self)))

    def explained(self) -> Array:
        """Part of the samples' variance that the model explains, shape (P,), over all channels."""
        return 1.0 - self.residual_rms**2 / np.maximum(self.spread_rms**2, 1.0)


def local_px_per_u(image_from_plate: Array) -> Array:
    """Scale at the plates' centres, shape (P,): the square root of the area of a square u in px."""
    return area_scales(homography_jacobians(image_from_plate, CENTRE_U))[:, 0]


def measure_plates(pyramid: Pyramid, image_from_plate: Array, blur_px: Array) -> PlateFits:
    """Fit all plates, each on the grid for its size; parameters as ``fit_plates``."""
    large = local_px_per_u(image_from_plate) > PatchGrid.FINE.px_per_u_max
    if not large.any():
        return fit_plates(pyramid, image_from_plate, blur_px, PatchGrid.FINE)
    parts = [
        fit_plates(pyramid, image_from_plate[chosen], blur_px[chosen], grid)
        for chosen, grid in ((~large, PatchGrid.FINE), (large, PatchGrid.DENSE))
    ]
    position = np.argsort(np.concatenate([np.flatnonzero(~large), np.flatnonzero(large)]))
    return PlateFits(
        *(np.concatenate([getattr(part, field.name) for part in parts])[position] for field in fields(PlateFits))
    )


def fit_plates(pyramid: Pyramid, image_from_plate: Array, blur_px: Array, grid: PatchGrid) -> PlateFits:
    """Sample and fit all plates.

    Parameters
    ----------
    pyramid : Pyramid
    image_from_plate : ndarray of shape (P, 3, 3)
        Rough homographies: good to half a dot's radius.
    blur_px : ndarray of shape (P,)
        Standard deviation of the blur in the photograph's own pixels.
    grid : PatchGrid
        Plates larger than it is for are measured at a halved size.
    """
    samples, levels = _patches(pyramid, image_from_plate, blur_px, grid)
    return _solve(samples, levels, grid, image_from_plate)


def _patches(
    pyramid: Pyramid, image_from_plate: Array, blur_px: Array, grid: PatchGrid
) -> tuple[Array32, npt.NDArray[np.int64]]:
    """Samples of all patches, shape (P, 3, S), and the template level for each."""
    px_per_u = local_px_per_u(image_from_plate)
    halvings = np.ceil(np.log2(np.maximum(px_per_u / grid.px_per_u_max, 1.0))).astype(np.int64)
    halvings = np.minimum(halvings, len(pyramid.levels) - 1)
    # Larger pixels blur: a box of n px has a variance of n^2 / 12, the triangle of bilinear sampling of n^2 / 6.
    pixel_px2 = (4.0**halvings - 1.0) * (1.0 / 12.0 + 1.0 / 6.0)
    levels = blur_level(np.sqrt(blur_px**2 + pixel_px2) / px_per_u)
    return _sample(pyramid, image_from_plate, halvings, grid), levels


def fit_under_blurs(pyramid: Pyramid, image_from_plate: Array, blurs_px: tuple[float, ...]) -> PlateFits:
    """The same plates fitted under every blur from one sampling; blur by blur, shape (B * P, ...)."""
    px_per_u = local_px_per_u(image_from_plate)
    samples = _sample(pyramid, image_from_plate, np.zeros(len(image_from_plate), dtype=np.int64), PatchGrid.FINE)
    levels = blur_level(np.divide.outer(np.array(blurs_px), px_per_u)).ravel()
    times = len(blurs_px)
    return _solve(np.tile(samples, (times, 1, 1)), levels, PatchGrid.FINE, np.tile(image_from_plate, (times, 1, 1)))


def cell_residuals(pyramid: Pyramid, fits: PlateFits, blur_px: Array) -> Array:
    """Root mean square of samples minus model in each dot's cell, all channels, shape (P, 16), linear light.

    What covers a dot does not look like any ink on black, whatever amplitude it takes.
    """
    grid = PatchGrid.FINE
    samples, levels = _patches(pyramid, fits.image_from_plate, blur_px, grid)
    cells = np.linalg.norm(grid.points_u()[:, None] - PLATE_DOTS_U, axis=2).argmin(axis=1)
    member = (cells[:, None] == np.arange(DOT_COUNT)).astype(np.float64)
    power = np.empty((len(samples), DOT_COUNT))
    for plate, level in enumerate(levels):
        template = plate_template(grid, int(level))
        solved = samples[plate] @ template.design @ template.cofactors
        residual = samples[plate] - solved @ template.design.T
        power[plate] = (residual**2).mean(axis=0) @ member
    result: Array = np.sqrt(power / member.sum(axis=0))
    return result


def _sample(pyramid: Pyramid, image_from_plate: Array, halvings: npt.NDArray[np.int64], grid: PatchGrid) -> Array32:
    """Bilinear samples of all patches in linear light, shape (P, 3, S)."""
    homogeneous = grid.homogeneous_u()
    samples = np.empty((len(image_from_plate), CHANNELS, len(homogeneous)), dtype=np.float32)
    for halving in np.unique(halvings):
        chosen = np.flatnonzero(halvings == halving)
        # Pixel centres stand at integers: the centre of a halved pixel lies between those of its parts.
        factor = 0.5**halving
        shift = 0.5 * factor - 0.5
        level_from_image = np.array([[factor, 0.0, shift], [0.0, factor, shift], [0.0, 0.0, 1.0]])
        level_from_plate = (level_from_image @ image_from_plate[chosen]).astype(np.float32)
        x, y, w = (level_from_plate @ homogeneous.T).transpose(1, 0, 2)
        level = pyramid.levels[halving]
        coded = cv2.remap(level, x / w, y / w, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        samples[chosen] = cv2.LUT(coded, LINEAR_FROM_CODED).transpose(0, 2, 1)
    return samples


def _solve(samples: Array32, levels: npt.NDArray[np.int64], grid: PatchGrid, image_from_plate: Array) -> PlateFits:
    """Normal equations of all plates; the residuals' power follows from them without forming a residual."""
    plates, _, count = samples.shape
    coefficients = np.empty((plates, CHANNELS, COEFFICIENTS))
    sums = np.empty((plates, CHANNELS))
    explained_power = np.empty(plates)
    cofactors = np.empty((plates, DOT_COUNT, 2, 2))
    for level in np.unique(levels):
        template, chosen = plate_template(grid, int(level)), np.flatnonzero(levels == level)
        # One product for all plates and channels.
        right_hand = (samples[chosen].reshape(-1, count) @ template.design).astype(np.float64)
        solved = right_hand @ template.cofactors
        gained = (solved * (2.0 * right_hand - solved @ template.normals)).sum(axis=1)
        coefficients[chosen] = solved.reshape(-1, CHANNELS, COEFFICIENTS)
        explained_power[chosen] = gained.reshape(-1, CHANNELS).sum(axis=1)
        # The background's constant column is 1 everywhere, so its product is the sum of the samples.
        sums[chosen] = right_hand[:, BACKGROUND.start].reshape(-1, CHANNELS)
        cofactors[chosen] = template.offset_cofactors
    flat = samples.reshape(plates, CHANNELS * count)
    power = np.einsum("ps,ps->p", flat, flat).astype(np.float64)
    spread = power - (sums**2).sum(axis=1) / count
    dots = coefficients[:, :, : BACKGROUND.start].reshape(plates, CHANNELS, DOT_COUNT, PER_DOT)
    return PlateFits(
        image_from_plate=image_from_plate,
        px_per_u=local_px_per_u(image_from_plate),
        amplitudes=dots[..., 0].transpose(0, 2, 1),
        slopes=dots[..., 1:].transpose(0, 2, 1, 3),
        background=coefficients[:, :, BACKGROUND.start],
        residual_rms=np.sqrt(np.maximum(power - explained_power, 0.0) / (CHANNELS * count)),
        spread_rms=np.sqrt(np.maximum(spread, 0.0) / (CHANNELS * count)),
        offset_cofactors=cofactors,
    )
