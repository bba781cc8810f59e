"""Pictures of plates resampled in plate coordinates, in linear light."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev, Polynomial

from app.vision.homography import apply_homographies, local_px_per_u
from app.vision.kernels.coefficients import CHANNELS
from app.vision.kernels.sampling import LIGHT_DEGREE, sample_plates
from app.vision.template import PATCH_REACH_U, PatchGrid, blur_level

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

# Variance, in its own pixels, that a pixel adds to a picture: its box, and the triangle of bilinear sampling.
PIXEL_VARIANCE = 1.0 / 12.0 + 1.0 / 6.0

# What a sample takes from beyond its own place.
MARGIN_PX = 2
PATCH_CORNERS_U = PATCH_REACH_U * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


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
        return cls(np.ascontiguousarray(bgr), min(count - 1, possible))

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the photograph."""
        return self.bgr.shape[1], self.bgr.shape[0]

    def halved_around(self, points_px: Array, halvings: int) -> tuple[Pixels, npt.NDArray[np.int64]]:
        """The part around points, every pixel averaged over a block of 2^halvings, and its first pixel (x, y).

        Large plates fill little of a photograph: halving all of it costs a tenth of decoding it.
        """
        block = 2**halvings
        # Whole blocks only: an odd last row or column would shift the grid.
        blocks = np.array(self.size_px) // block
        first = np.clip(np.floor(points_px.min(axis=0) / block) - MARGIN_PX, 0, blocks - 1).astype(np.int64)
        last = np.clip(np.ceil(points_px.max(axis=0) / block) + MARGIN_PX, first + 1, blocks).astype(np.int64)
        (left, top), (right, bottom) = first * block, last * block
        part: Pixels = self.bgr[top:bottom, left:right]
        for _ in range(halvings):
            half = cv2.resize(part, (part.shape[1] // 2, part.shape[0] // 2), interpolation=cv2.INTER_AREA)
            part = np.asarray(half, dtype=np.uint8)
        return part, first * block


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
    halvings = np.minimum(halvings, pyramid.halvings_max)
    samples = np.empty((len(image_from_plate), CHANNELS, grid.value**2), dtype=np.float32)
    axis_u, homographies = grid.axis_u(), image_from_plate.copy()
    whole = np.flatnonzero(halvings == 0)
    sample_plates(_two_each_way(pyramid.bgr), homographies, whole, 1.0, axis_u, light_curve(), samples)
    for plate in np.flatnonzero(halvings):
        part, first_px = pyramid.halved_around(_corners_px(image_from_plate[plate]), int(halvings[plate]))
        homographies[plate, :2] -= first_px[:, None] * homographies[plate, 2]
        factor = float(0.5 ** halvings[plate])
        sample_plates(_two_each_way(part), homographies, np.array([plate]), factor, axis_u, light_curve(), samples)
    pixel_px2 = (4.0 ** halvings.astype(np.float64) - 1.0) * PIXEL_VARIANCE
    return Patches(samples, image_from_plate, px_per_u, pixel_px2, grid)


def _two_each_way(pixels: Pixels) -> Pixels:
    """The picture; one of a single row or column with that repeated, for samples are taken between two."""
    missing = [(0, max(2 - length, 0)) for length in pixels.shape[:2]]
    return np.pad(pixels, [*missing, (0, 0)], mode="edge") if min(pixels.shape[:2]) < 2 else pixels


def _corners_px(image_from_plate: Array) -> Array:
    """Pixels, shape (4, 2), of a patch's corners; any finite ones of a plate that reaches behind the camera."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(apply_homographies(image_from_plate[None], PATCH_CORNERS_U)[0])
