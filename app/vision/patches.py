"""Pictures of plates resampled in plate coordinates, in linear light."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev, Polynomial

from app.vision.kernels.coefficients import CHANNELS
from app.vision.kernels.sampling import LIGHT_DEGREE, sample_plates
from app.vision.template import PATCH_REACH_U, PatchGrid, blur_level

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

# Variance, in its own pixels, that a pixel adds to a picture: its box, and the triangle of bilinear sampling.
PIXEL_VARIANCE = 1.0 / 12.0 + 1.0 / 6.0

HALVINGS_MAX = 16  # a picture of 65,536 pixels a side is a single one then
# What is added beyond the photograph's own pixels, after so many halvings.
PIXEL_VARIANCES_PX2 = np.array([(4.0**halvings - 1.0) * PIXEL_VARIANCE for halvings in range(HALVINGS_MAX + 1)])


GREY_MAX = 255.0
CURVE_BEGINS_GREY, CURVE_STRAIGHT = 0.04045 * GREY_MAX, 1.0 / 12.92  # sRGB's line in the dark, and its slope
CURVE_PLACES = 1000


def linear_of_coded(grey: Array) -> Array:
    """Linear light of sRGB-coded grey values, both 0 ... 255: blur is linear in light, and so is ink.

    Phones' tone curves differ from sRGB's, but all of them widen bright dots on black, which this undoes.
    """
    bent = ((grey / GREY_MAX + 0.055) / 1.055) ** 2.4  # IEC 61966-2-1
    return np.where(grey <= CURVE_BEGINS_GREY, CURVE_STRAIGHT * grey, GREY_MAX * bent)


@cache
def light_curve() -> Array32:
    """The same as ``sample_plates`` takes it: a polynomial behind the line, fitted so that it errs evenly."""
    from_dark = 0.5 - 0.5 * np.cos(np.pi * (np.arange(CURVE_PLACES) + 0.5) / CURVE_PLACES)
    grey = CURVE_BEGINS_GREY + (GREY_MAX - CURVE_BEGINS_GREY) * from_dark
    fitted = Chebyshev.fit(grey, linear_of_coded(grey), LIGHT_DEGREE).convert(kind=Polynomial)
    return np.array([*fitted.coef, CURVE_BEGINS_GREY, CURVE_STRAIGHT], dtype=np.float32)


LINEAR_FROM_CODED = linear_of_coded(np.arange(GREY_MAX + 1.0)).astype(np.float32)


@dataclass(frozen=True)
class Pyramid:
    """A photograph that is halved where plates need it, so that a patch's samples stand 1-2 px apart at any size.

    Attributes
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    halvings_max : int
        How often it may be halved.
    """

    bgr: Pixels
    halvings_max: int

    @classmethod
    def of(cls, bgr: Pixels, count: int) -> Pyramid:
        """Of ``count`` sizes, or as many as leave a pixel."""
        possible = int(np.log2(max(min(bgr.shape[:2]), 1)))
        return cls(np.ascontiguousarray(bgr), min(count - 1, possible, HALVINGS_MAX))

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the photograph."""
        return self.bgr.shape[1], self.bgr.shape[0]


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

    def levels(self, blur_px: Array, chosen: npt.NDArray[np.intp] | slice = slice(None)) -> npt.NDArray[np.int64]:
        """Template level of each plate, or of some, for a blur of the photograph, px of standard deviation."""
        return blur_level(np.sqrt(blur_px**2 + self.pixel_px2[chosen]) / self.px_per_u[chosen])


def take_patches(pyramid: Pyramid, image_from_plate: Array, grid: PatchGrid) -> Patches:
    """Bilinear samples of all plates, each from the halving that suits its size."""
    count = len(image_from_plate)
    samples = np.empty((count, CHANNELS, grid.value**2), dtype=np.float32)
    px_per_u, halvings = np.empty(count), np.empty(count, dtype=np.int64)
    bounds, tables = (grid.px_per_u_max, pyramid.halvings_max, PATCH_REACH_U), (grid.axis_u(), light_curve())
    sample_plates(pyramid.bgr, np.ascontiguousarray(image_from_plate), bounds, tables, (samples, px_per_u, halvings))
    return Patches(samples, image_from_plate, px_per_u, PIXEL_VARIANCES_PX2[halvings], grid)
