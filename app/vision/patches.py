"""Pictures of plates resampled in plate coordinates, in linear light."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from app.vision.homography import apply_homographies, local_px_per_u
from app.vision.kernels.coefficients import CHANNELS
from app.vision.kernels.sampling import LIGHT_STEPS, sample_plates
from app.vision.template import PATCH_REACH_U, PatchGrid, blur_level

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

# Variance, in its own pixels, that a pixel adds to a picture: its box, and the triangle of bilinear sampling.
PIXEL_VARIANCE = 1.0 / 12.0 + 1.0 / 6.0

# What a sample takes from beyond its own place, and what the numbers that hold two pixels reach over.
MARGIN_PX = 2
PATCH_CORNERS_U = PATCH_REACH_U * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


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
    sample_plates(pyramid.bgr, homographies, whole, 1.0, axis_u, FINE_LINEAR_FROM_CODED, samples)
    for plate in np.flatnonzero(halvings):
        part, first_px = pyramid.halved_around(_corners_px(image_from_plate[plate]), int(halvings[plate]))
        homographies[plate, :2] -= first_px[:, None] * homographies[plate, 2]
        factor = float(0.5 ** halvings[plate])
        sample_plates(part, homographies, np.array([plate]), factor, axis_u, FINE_LINEAR_FROM_CODED, samples)
    pixel_px2 = (4.0 ** halvings.astype(np.float64) - 1.0) * PIXEL_VARIANCE
    return Patches(samples, image_from_plate, px_per_u, pixel_px2, grid)


def _corners_px(image_from_plate: Array) -> Array:
    """Pixels, shape (4, 2), of a patch's corners; any finite ones of a plate that reaches behind the camera."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(apply_homographies(image_from_plate[None], PATCH_CORNERS_U)[0])
