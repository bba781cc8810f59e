"""Plates that something covers from a side: fitted, and judged, by what of them is in sight.

The fit of a whole plate takes what stands before it for a badly printed one. Where the lines of black between the dots
end in another colour (``covered_sides``), plates are fitted again without that part. What is left must then look like a
plate all the more: a fit that may leave out what does not suit it explains more of anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS, DOT_COUNT
from app.vision.centres import CentreOptions, locate_dots, refine_homographies
from app.vision.covered_sides import CoveredSides, SideOptions, covered_sides
from app.vision.inks import InkOptions, read_inks
from app.vision.kernels.inkwell import RED
from app.vision.measurement import PlateFits
from app.vision.patches import Pyramid, take_patches
from app.vision.template import PatchGrid
from app.vision.visible_fit import VisibleFits, fit_visible

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

BASE = list(BASE_CELLS)
THIRD = 2  # of five in order: two base dots may be covered


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
    sides : SideOptions
    inks : InkOptions
    centres : CentreOptions
    """

    doubted_below: float = 0.9
    doubted_above: float = 0.25
    plates_max: int = 60
    explained_min: float = 0.9
    base_hidden_max: int = 2
    rounds: int = 2
    first_explained_min: float = 0.75
    grid: PatchGrid = PatchGrid.FINE
    sides: SideOptions = field(default_factory=SideOptions)
    inks: InkOptions = field(default_factory=InkOptions)
    centres: CentreOptions = field(default_factory=CentreOptions)

    def reading(self, inks: InkOptions, centres: CentreOptions) -> PartOptions:
        """With dots read and placed as those of whole plates."""
        return replace(self, inks=inks, centres=centres)

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
    doubted = _doubted(fits, options)
    if not len(doubted):
        return _put_together(fits, [])
    red = np.concatenate([third_red(fits.amplitudes[doubted])] * len(starts))
    image_from_plate = np.concatenate([start[doubted] for start in starts])
    sides = covered_sides(pyramid.bgr, red, image_from_plate, options.sides)
    found, left = list[tuple[Indices, VisibleFits]](), np.ones(len(doubted), dtype=np.bool_)
    start, place = np.divmod(sides.covered(), len(doubted))
    for number in range(len(starts)):
        likely = place[(start == number) & left[place]]
        if len(likely):
            stands, visible = fit_covered(pyramid, sides.select(number * len(doubted) + likely), blur_px, options)
            found.append((doubted[likely[stands]], visible))
            left[likely[stands]] = False
    return _put_together(fits, found)


def _doubted(fits: PlateFits, options: PartOptions) -> Indices:
    """Plates that may be covered, the best explained first."""
    explained = fits.explained()
    doubtful = (explained < options.doubted_below) | ~read_inks(fits.amplitudes, options.inks).red_base.all(axis=1)
    doubted = np.flatnonzero(doubtful & (explained > options.doubted_above))
    return doubted[np.argsort(-explained[doubted], kind="stable")[: options.plates_max]]


def _put_together(fits: PlateFits, found: Sequence[tuple[Indices, VisibleFits]]) -> PartsInSight:
    """Fits of whole plates, and in their places those of what is seen of some plates."""
    hidden = np.zeros((len(fits.px_per_u), DOT_COUNT), dtype=np.bool_)
    if not any(len(plates) for plates, _ in found):
        return PartsInSight(fits, hidden, hidden)
    cut, parts = hidden.copy(), [getattr(fits, part.name).copy() for part in fields(fits)]
    for plates, visible in found:
        hidden[plates], cut[plates] = visible.hidden, visible.cut
        for part, field_of in zip(parts, fields(fits), strict=True):
            part[plates] = getattr(visible.fits, field_of.name)
    return PartsInSight(PlateFits(*parts), hidden, cut)


def third_red(amplitudes: Array) -> Array:
    """Red of the third brightest base dot, shape (P,), from amplitudes (P, 16, 3): two of the five may be covered."""
    return np.sort(amplitudes[:, BASE, RED], axis=1)[:, THIRD]


def fit_covered(
    pyramid: Pyramid, sides: CoveredSides, blur_px: float, options: PartOptions = PartOptions()
) -> tuple[Indices, VisibleFits]:
    """Those of some plates, all covered from a side, that look like plates beside it, and their fits."""
    found = np.arange(len(sides.red))
    for rounds_left in reversed(range(options.rounds)):
        if not len(found):
            return found, VisibleFits.none()
        patches = take_patches(pyramid, sides.image_from_plate, options.grid)
        visible = fit_visible(patches, blur_px, sides.seen(options.grid.points_u()))
        if rounds_left:
            sides = covered_sides(pyramid.bgr, sides.red, _refined(visible, pyramid.size_px, options), options.sides)
            likely = sides.covered()
            found, sides = found[likely], sides.select(likely)
    few_hidden = visible.hidden[:, BASE].sum(axis=1) <= options.base_hidden_max
    stands = np.flatnonzero(few_hidden & (visible.fits.explained() > options.explained_min))
    return (found, visible) if len(stands) == len(found) else (found[stands], visible.select(stands))


def _refined(visible: VisibleFits, size_px: tuple[int, int], options: PartOptions) -> Array:
    inks = read_inks(visible.fits.amplitudes, options.inks).behind(visible.hidden, visible.cut)
    return refine_homographies(visible.fits, locate_dots(visible.fits, inks, size_px, options.centres))
