"""Template fits of plates that are seen in part: only the samples in sight have a say.

A board before a plate is no part of its picture. Where it lies is known from elsewhere (``covered_sides``); its samples
are left out of the normal equations, and out of what the fit is judged by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.targets.layout import DOT_COUNT
from app.vision.kernels.coefficients import BACKGROUND, CHANNELS, COEFFICIENTS, PAPER, PER_DOT
from app.vision.measurement import PlateFits
from app.vision.patches import Patches
from app.vision.template import PAPER_RIDGE, PATCH_REACH_U, shelf_with

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]

# Of a dot's own picture: what tells its colour, and, but for the skirts of its blur, where it stands.
READ_SHARE, PLACED_SHARE = 0.35, 0.95
# What keeps the equations of a dot solvable of which nothing is seen: far below any sample's weight.
HIDDEN_RIDGE = 1e-3
FIRST_SLOPES = PER_DOT * np.arange(DOT_COUNT)[:, None, None] + 1


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
        shapes = ((3, 3), (), (DOT_COUNT, CHANNELS), (DOT_COUNT, 2, CHANNELS), (CHANNELS,), (), (), (DOT_COUNT, 2, 2))
        parts = [np.empty((0, *shape)) for shape in (*shapes, (CHANNELS, COEFFICIENTS - BACKGROUND))]
        return cls(PlateFits(*parts), np.empty((0, DOT_COUNT)))

    @classmethod
    def joined(cls, lots: Sequence[VisibleFits]) -> VisibleFits:
        """The fits of several lots of plates, one after the other."""
        return cls(PlateFits.joined([lot.fits for lot in lots]), np.concatenate([lot.shares for lot in lots]))

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
    plates = len(patches.samples)
    levels = patches.levels(np.full(plates, blur_px))
    shelf = shelf_with(patches.grid, levels)
    solved, rms = np.zeros((plates, COEFFICIENTS, CHANNELS)), np.zeros((plates, 2))
    cofactors, shares = np.zeros((plates, COEFFICIENTS, COEFFICIENTS)), np.empty((plates, DOT_COUNT))
    for plate, level in enumerate(levels.tolist()):
        design = shelf.design(level)
        discs, in_sight = design[:, :BACKGROUND:PER_DOT], seen[plate]
        shares[plate] = discs[in_sight].sum(axis=0) / discs.sum(axis=0)
        samples = patches.samples[plate][:, in_sight].T
        solved[plate], cofactors[plate], rms[plate] = _solve(design[in_sight], samples)
    dots = solved[:, :BACKGROUND].reshape(plates, DOT_COUNT, PER_DOT, CHANNELS)
    dots[shares < READ_SHARE] = 0.0
    planes = np.ascontiguousarray(solved[:, BACKGROUND:].transpose(0, 2, 1))
    planes[..., [1, 2, 4, 5]] /= PATCH_REACH_U
    fits = PlateFits(
        image_from_plate=patches.image_from_plate,
        px_per_u=patches.px_per_u,
        amplitudes=np.ascontiguousarray(dots[:, :, 0]),
        slopes=np.ascontiguousarray(dots[:, :, 1:]),
        background=planes[:, :, 0],
        residual_rms=rms[:, 0],
        spread_rms=rms[:, 1],
        offset_cofactors=cofactors[:, FIRST_SLOPES + np.arange(2)[:, None], FIRST_SLOPES + np.arange(2)],
        planes=planes,
    )
    return VisibleFits(fits, shares)


def _solve(model: Array32, samples: Array32) -> tuple[Array, Array, Array]:
    """Coefficients (54, 3), cofactors (54, 54), and root mean squares of what is left and of what there was."""
    ridge = np.full(COEFFICIENTS, HIDDEN_RIDGE)
    ridge[PAPER:] = PAPER_RIDGE * len(samples)
    cofactors: Array = np.asarray(
        np.linalg.inv((model.T @ model).astype(np.float64) + np.diag(ridge)), dtype=np.float64
    )
    solved: Array = np.asarray(cofactors @ (model.T @ samples).astype(np.float64), dtype=np.float64)
    left, spread = samples - model @ solved.astype(np.float32), samples - samples.mean(axis=0)
    return solved, cofactors, np.array([_root_mean_square(left), _root_mean_square(spread)])


def _root_mean_square(values: Array32) -> float:
    return float(np.sqrt(np.vdot(values, values) / values.size))
