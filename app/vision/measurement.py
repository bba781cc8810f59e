"""Fit the plate template to many plates at once: colours and places of all sixteen dots from the pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.targets.layout import DOT_COUNT
from app.vision.homography import local_px_per_u
from app.vision.kernels.coefficients import BACKGROUND, CHANNELS, COEFFICIENTS
from app.vision.kernels.fitting import fit_plates
from app.vision.patches import Patches, Pyramid, take_patches
from app.vision.template import PAPER_RIDGE, PATCH_REACH_U, PatchGrid, shelf_with

Array = npt.NDArray[np.float64]


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
    slopes : ndarray of shape (P, 16, 2, 3)
        The derivative coefficients along x and y per channel, linear light per u.
    residual_rms : ndarray of shape (P,)
        Root mean square of samples minus model, over all channels.
    spread_rms : ndarray of shape (P,)
        Root mean square of the samples about each channel's mean: what a fit that explains nothing would leave.
    offset_cofactors : ndarray of shape (P, 16, 2, 2)
        Cofactors of the derivative coefficients.
    planes : ndarray of shape (P, 3, 6)
        Per channel, the plate's black (constant, and per u along x and y), then what the paper adds to it (the same).
    """

    image_from_plate: Array
    px_per_u: Array
    amplitudes: Array
    slopes: Array
    residual_rms: Array
    spread_rms: Array
    offset_cofactors: Array
    planes: Array

    def fitted(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """What a fit finds, in the order in which compiled loops write it."""
        return (self.amplitudes, self.slopes, self.planes, self.residual_rms, self.spread_rms, self.offset_cofactors)

    def select(self, chosen: npt.NDArray[np.intp]) -> PlateFits:
        """The fits of some plates."""
        return PlateFits(*(getattr(self, part.name)[chosen] for part in fields(self)))

    @classmethod
    def room_for(cls, image_from_plate: Array, px_per_u: Array) -> PlateFits:
        """Of plates that are yet to be fitted."""
        count, planes = len(px_per_u), np.empty((len(px_per_u), CHANNELS, COEFFICIENTS - BACKGROUND))
        amplitudes, slopes = np.empty((count, DOT_COUNT, CHANNELS)), np.empty((count, DOT_COUNT, 2, CHANNELS))
        cofactors, (residual_rms, spread_rms) = np.empty((count, DOT_COUNT, 2, 2)), np.empty((2, count))
        fitted = (amplitudes, slopes, residual_rms, spread_rms, cofactors, planes)
        return cls(image_from_plate, px_per_u, *fitted)

    @classmethod
    def joined(cls, parts: Sequence[PlateFits]) -> PlateFits:
        """The fits of several lots of plates, one after the other."""
        filled = [part for part in parts if len(part.px_per_u)]
        if len(filled) == 1:
            return filled[0]
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))

    @property
    def background(self) -> Array:
        """Blue, green, red of the plates' black at their middles, shape (P, 3)."""
        return self.planes[:, :, 0]

    def explained(self) -> Array:
        """Part of the samples' variance that the model explains, shape (P,), over all channels; 0 where all is flat."""
        return self._explained

    @cached_property
    def _explained(self) -> Array:
        flat = self.spread_rms < 1.0  # grey value: a patch that has collapsed to a point, or a plain wall
        return np.where(flat, 0.0, 1.0 - self.residual_rms**2 / np.maximum(self.spread_rms**2, 1.0))


@dataclass(frozen=True)
class SizedPatches:
    """Patches of P plates, each on the grid for its size.

    Attributes
    ----------
    parts : tuple of Patches
        One or two grids.
    plates : ndarray of shape (P,)
        The plate of each patch, part after part.
    """

    parts: tuple[Patches, ...]
    plates: npt.NDArray[np.intp]

    @classmethod
    def of(cls, pyramid: Pyramid, image_from_plate: Array) -> SizedPatches:
        """Sample all plates through homographies of shape (P, 3, 3), good to half a dot's radius."""
        large = local_px_per_u(image_from_plate) > PatchGrid.FINE.px_per_u_max
        sizes = [(np.flatnonzero(~large), PatchGrid.FINE), (np.flatnonzero(large), PatchGrid.DENSE)]
        sizes = [(chosen, grid) for chosen, grid in sizes if len(chosen)]
        parts = tuple(take_patches(pyramid, image_from_plate[chosen], grid) for chosen, grid in sizes)
        return cls(parts, np.concatenate([chosen for chosen, _ in sizes]))

    def fit(self, blur_px: float) -> PlateFits:
        """Fit all plates under one blur (standard deviation in the photograph's own pixels), in the plates' order."""
        if len(self.parts) == 1:
            return fit_patches(self.parts[0], np.full(len(self.plates), blur_px))
        order = np.argsort(self.plates)
        image_from_plate = np.concatenate([part.image_from_plate for part in self.parts])[order]
        px_per_u = np.concatenate([part.px_per_u for part in self.parts])[order]
        fits, first = PlateFits.room_for(image_from_plate, px_per_u), 0
        for part in self.parts:
            each = np.arange(len(part.px_per_u))
            levels = part.levels(np.full(len(each), blur_px))
            _fit_into(fits, part, np.stack([each, levels, self.plates[first : first + len(each)]]))
            first += len(each)
        return fits

    def fit_some(self, count: int, blurs_px: tuple[float, ...]) -> PlateFits:
        """A few plates of the smaller kind fitted under every blur; blur by blur, shape (B * few, ...)."""
        smaller = self.parts[0]
        few = np.arange(len(smaller.samples))[:: max(1, len(smaller.samples) // count)][:count]
        return fit_patches(smaller, np.repeat(blurs_px, len(few)), np.tile(few, len(blurs_px)))


def fit_patches(patches: Patches, blur_px: Array, chosen: npt.NDArray[np.intp] | None = None) -> PlateFits:
    """Normal equations of many plates; the residuals' power follows from them without forming a residual.

    Parameters
    ----------
    patches : Patches
    blur_px : ndarray of shape (N,)
        Standard deviation of the blur in the photograph's own pixels.
    chosen : ndarray of shape (N,), optional
        The patches that are fitted, one perhaps several times; else each of them once.
    """
    each = np.arange(len(blur_px))
    if chosen is None:
        chosen = each
    fits = PlateFits.room_for(patches.image_from_plate[chosen], patches.px_per_u[chosen])
    _fit_into(fits, patches, np.stack([chosen, patches.levels(blur_px, chosen), each]))
    return fits


def _fit_into(fits: PlateFits, patches: Patches, orders: npt.NDArray[np.int64]) -> None:
    """Fit patches as ``orders``, shape (3, N), say: the patch, the level of its template, the row that is written."""
    samples = patches.samples
    shelf = shelf_with(patches.grid, orders[1])
    fit_plates(samples, orders, shelf.parts, (PAPER_RIDGE * samples.shape[2], PATCH_REACH_U), fits.fitted())
