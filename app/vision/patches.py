"""Pictures of plates resampled in plate coordinates, in linear light."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from app.vision.homography import local_px_per_u
from app.vision.kernels.coefficients import CHANNELS
from app.vision.kernels.sampling import LIGHT_STEPS, sample_plates
from app.vision.template import PatchGrid, blur_level

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

# Variance, in its own pixels, that a pixel adds to a picture: its box, and the triangle of bilinear sampling.
PIXEL_VARIANCE = 1.0 / 12.0 + 1.0 / 6.0


def linear_from_coded(steps: int) -> Array32:
    """Linear light, 0 ... 255, of sRGB-coded grey values in so many steps each: blur is linear in light, and so is ink.

    Phones' tone curves differ from sRGB's, but all of them widen bright dots on black, which this undoes.
    """
    coded = np.linspace(0.0, 1.0, 255 * steps + 1)
    linear = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    return (255.0 * linear).astype(np.float32)


LINEAR_FROM_CODED = linear_from_coded(1)
FINE_LINEAR_FROM_CODED = linear_from_coded(LIGHT_STEPS)


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
        levels: list[Pixels] = [np.ascontiguousarray(bgr)]
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
class Patches:
    """Samples of P plates on one grid.

    Attributes
    ----------
    samples : ndarray of shape (P, 3, S), float32
        Blue, green, red in linear light of 0 ... 255.
    image_from_plate : ndarray of shape (P, 3, 3)
        The homographies they were taken with.
    px_per_u : ndarray of shape (P,)
        Local scale at the plate's centre: the square root of the area of a square u.
    pixel_px2 : ndarray of shape (P,)
        Variance that the larger pixels of a halved photograph add to the blur.
    grid : PatchGrid
    """

    samples: Array32
    image_from_plate: Array
    px_per_u: Array
    pixel_px2: Array
    grid: PatchGrid

    def levels(self, blur_px: Array) -> npt.NDArray[np.int64]:
        """Template level of each plate for a blur of the photograph, px of standard deviation."""
        return blur_level(np.sqrt(blur_px**2 + self.pixel_px2) / self.px_per_u)

    def select(self, chosen: npt.NDArray[np.intp]) -> Patches:
        """Some of the patches; one may be chosen several times."""
        return Patches(
            self.samples[chosen],
            self.image_from_plate[chosen],
            self.px_per_u[chosen],
            self.pixel_px2[chosen],
            self.grid,
        )


def take_patches(pyramid: Pyramid, image_from_plate: Array, grid: PatchGrid) -> Patches:
    """Bilinear samples of all plates, each from the halving that suits its size."""
    px_per_u = local_px_per_u(image_from_plate)
    halvings = np.ceil(np.log2(np.maximum(px_per_u / grid.px_per_u_max, 1.0))).astype(np.int64)
    halvings = np.minimum(halvings, len(pyramid.levels) - 1)
    samples = np.empty((len(image_from_plate), CHANNELS, grid.value**2), dtype=np.float32)
    for halving in np.unique(halvings):
        chosen, level = np.flatnonzero(halvings == halving), pyramid.levels[halving]
        factor = float(0.5**halving)
        sample_plates(level, image_from_plate, chosen, factor, grid.axis_u(), FINE_LINEAR_FROM_CODED, samples)
    pixel_px2 = (4.0 ** halvings.astype(np.float64) - 1.0) * PIXEL_VARIANCE
    return Patches(samples, image_from_plate, px_per_u, pixel_px2, grid)
