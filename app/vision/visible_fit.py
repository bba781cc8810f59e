"""Template fits of plates that are seen in part: only the samples in sight have a say.

A board before a plate is no part of its picture. Where it lies is known from elsewhere (``covered_sides``); its samples
are left out of the normal equations, and out of what the fit is judged by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.targets.layout import DOT_COUNT
from app.vision.kernels.visible import fit_seen
from app.vision.measurement import PlateFits
from app.vision.patches import Patches
from app.vision.template import PAPER_RIDGE, PATCH_REACH_U, shelf_with

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# Of a dot's own picture: what tells its colour, and, but for the skirts of its blur, where it stands.
READ_SHARE, PLACED_SHARE = 0.35, 0.95
# What keeps the equations of a dot solvable of which nothing is seen: far below any sample's weight.
HIDDEN_RIDGE = 1e-3


@dataclass(frozen=True)
class VisibleFits:
    """Fits of P plates to what is seen of them.

    Attributes
    ----------
    fits : PlateFits
        Residuals and spread are those of the samples in sight.
    shares : ndarray of shape (P, 16)
        Part of each dot that is in sight.
    """

    fits: PlateFits
    shares: Array

    @classmethod
    def none(cls) -> VisibleFits:
        """Of no plate."""
        return cls(PlateFits.room_for(np.empty((0, 3, 3)), np.empty(0)), np.empty((0, DOT_COUNT)))

    def select(self, chosen: npt.NDArray[np.intp]) -> VisibleFits:
        """The fits of some plates."""
        return VisibleFits(self.fits.select(chosen), self.shares[chosen])

    @property
    def hidden(self) -> Mask:
        """Dots of which too little is seen to tell their ink, shape (P, 16)."""
        result: Mask = self.shares < READ_SHARE
        return result

    @property
    def cut(self) -> Mask:
        """Dots of which too little is seen to tell where they stand, shape (P, 16)."""
        result: Mask = self.shares < PLACED_SHARE
        return result


def fit_visible(patches: Patches, blur_px: float, seen: Mask) -> VisibleFits:
    """Fit plates under one blur to the samples in sight, ``seen`` of shape (P, S)."""
    fits = PlateFits.room_for(patches.image_from_plate, patches.px_per_u)
    shares, levels = np.empty(fits.amplitudes.shape[:2]), patches.levels(np.full(len(seen), blur_px))
    known = (HIDDEN_RIDGE, PAPER_RIDGE, PATCH_REACH_U, READ_SHARE)
    fit_seen(patches.samples, seen, levels, shelf_with(patches.grid, levels).parts, known, (*fits.fitted(), shares))
    return VisibleFits(fits, shares)
