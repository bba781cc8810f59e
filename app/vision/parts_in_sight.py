"""Plates that something covers from a side: fitted, and judged, by what of them is in sight.

The fit of a whole plate takes what stands before it for a badly printed one. Where the lines of black between the dots
end in another colour (``covered_sides``), plates are fitted again without that part. What is left must then look like a
plate all the more: a fit that may leave out what does not suit it explains more of anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS, DOT_COUNT
from app.vision.centres import CentreOptions, locate_dots, refine_homographies
from app.vision.covered_sides import SideOptions, covered_sides
from app.vision.inks import read_inks
from app.vision.kernels.inkwell import RED
from app.vision.measurement import PlateFits
from app.vision.patches import Pyramid, take_patches
from app.vision.template import PatchGrid
from app.vision.visible_fit import VisibleFits, fit_visible

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

BASE = list(BASE_CELLS)
THIRD = 2  # of five in order, greatest first: two base dots may be covered


@dataclass(frozen=True)
class PartOptions:
    """Which plates are looked at again, and what their part in sight must show.

    Attributes
    ----------
    doubted_below : float
        Plates of which the whole model explains less, and any that lack a red base dot; whole ones on good photographs
        reach 0.95.
    doubted_above : float
        Of less than this nothing is expected: plates a quarter covered by white paper have 0.3.
    plates_max : int
        The best explained of those: bounds the time a hostile picture can take.
    black_share_min : float
        Part of the lines of black in sight that must be black: cloth and walls are not.
    explained_min : float
        Part of the variance in sight that the model explains: plates have 0.98 in good light.
    base_hidden_max : int
        Base dots that may be covered.
    rounds : int
        Fits, each through the dots as the one before found them.
    first_explained_min : float
        At first sight, where places are good to half a dot's radius and the blur is not known.
    grid : PatchGrid
        Samples of a fit.
    """

    doubted_below: float = 0.9
    doubted_above: float = 0.25
    plates_max: int = 60
    black_share_min: float = 0.85
    explained_min: float = 0.9
    base_hidden_max: int = 2
    rounds: int = 2
    first_explained_min: float = 0.75
    grid: PatchGrid = PatchGrid.FINE
    sides: SideOptions = field(default_factory=SideOptions)

    def at_first_sight(self) -> PartOptions:
        """One rough fit."""
        return replace(self, rounds=1, explained_min=self.first_explained_min, grid=PatchGrid.ROUGH)


@dataclass(frozen=True)
class PartsInSight:
    """Fits of P plates, those of covered ones by their part in sight, and what is covered.

    Attributes
    ----------
    fits : PlateFits
    hidden, cut : ndarray of shape (P, 16), bool
        As of ``VisibleFits``; nothing of plates that were fitted whole.
    """

    fits: PlateFits
    hidden: Mask
    cut: Mask


def fit_in_sight(
    pyramid: Pyramid, fits: PlateFits, starts: Sequence[Array], blur_px: float, options: PartOptions = PartOptions()
) -> PartsInSight:
    """Fit those plates again that may be covered from a side.

    Parameters
    ----------
    pyramid : Pyramid
    fits : PlateFits
        Of whole plates.
    starts : sequence of ndarray of shape (P, 3, 3)
        Where they may be, the likeliest first: what covers a plate may have misled any of them.
    blur_px : float
    """
    explained, nothing = fits.explained(), np.zeros((len(fits.px_per_u), DOT_COUNT), dtype=np.bool_)
    doubtful = (explained < options.doubted_below) | ~read_inks(fits.amplitudes).red_base.all(axis=1)
    doubted = np.flatnonzero(doubtful & (explained > options.doubted_above))
    doubted = doubted[np.argsort(-explained[doubted], kind="stable")[: options.plates_max]]
    plates, lots = doubted[:0], list[VisibleFits]()
    for image_from_plate in starts:
        left = np.setdiff1d(doubted, plates)
        red = third_red(fits.select(left))
        found, visible = fit_covered(pyramid, image_from_plate[left], red, blur_px, options)
        plates = np.concatenate([plates, left[found]])
        lots.append(visible)
    if not len(plates):
        return PartsInSight(fits, nothing, nothing)
    visible = VisibleFits.joined(lots)
    rows = np.arange(len(explained))
    rows[plates] = len(explained) + np.arange(len(plates))
    hidden, cut = nothing.copy(), nothing.copy()
    hidden[plates], cut[plates] = visible.hidden, visible.cut
    return PartsInSight(PlateFits.joined([fits, visible.fits]).select(rows), hidden, cut)


def third_red(fits: PlateFits) -> Array:
    """Red of the third brightest base dot, shape (P,): two of the five may be covered."""
    return np.sort(fits.amplitudes[:, BASE, RED], axis=1)[:, ::-1][:, THIRD]


def fit_covered(
    pyramid: Pyramid, image_from_plate: Array, red: Array, blur_px: float, options: PartOptions = PartOptions()
) -> tuple[Indices, VisibleFits]:
    """Those of some plates that are covered from a side and look like plates beside it, and their fits.

    Parameters
    ----------
    image_from_plate : ndarray of shape (P, 3, 3)
        Good to half a dot's radius.
    red : ndarray of shape (P,)
        The base dots' red above black, linear light.
    """
    found = np.arange(len(image_from_plate))
    for last in [*[False] * (options.rounds - 1), True]:
        sides = covered_sides(pyramid.bgr, red[found], image_from_plate, options.sides)
        likely = np.flatnonzero(sides.any() & (sides.black_share > options.black_share_min))
        if not len(likely):
            return likely, VisibleFits.none()
        found, image_from_plate, sides = found[likely], image_from_plate[likely], sides.select(likely)
        patches = take_patches(pyramid, image_from_plate, options.grid)
        visible = fit_visible(patches, blur_px, sides.seen(options.grid.points_u()))
        if not last:
            image_from_plate = _refined(visible, pyramid.size_px)
    few_hidden = visible.hidden[:, BASE].sum(axis=1) <= options.base_hidden_max
    stands = np.flatnonzero(few_hidden & (visible.fits.explained() > options.explained_min))
    return found[stands], visible.select(stands)


def _refined(visible: VisibleFits, size_px: tuple[int, int]) -> Array:
    inks = read_inks(visible.fits.amplitudes).behind(visible.hidden, visible.cut)
    dots = locate_dots(visible.fits, inks, size_px, CentreOptions())
    return refine_homographies(visible.fits, dots)
