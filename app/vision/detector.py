"""The default detector: colour proposes, the plate's own picture localises and judges.

    photo -> red blobs -> groups of five -> first look -> template fit, twice -> inks -> code -> judgement

The first fit takes a plate from its blobs to a tenth of a dot, the second measures.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from app.geometry.observations import Detection
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS
from app.vision.centres import (
    CentreOptions,
    locate_dots,
    refine_homographies,
)
from app.vision.covering import CoveringOptions, covered_base_dots
from app.vision.dots import Blobs, DotOptions, find_red_blobs
from app.vision.grouping import GroupingOptions, group_base_dots
from app.vision.hidden_dots import HiddenDotOptions, complete_groups
from app.vision.hidden_sides import HiddenSideOptions, behind_sides
from app.vision.homography import image_from_corner_dots
from app.vision.ink_noise import weigh_by_ink
from app.vision.inks import InkOptions, read_inks
from app.vision.judgement import (
    JudgementOptions,
    judge_plates,
    misfit_px,
    one_dot_one_target,
)
from app.vision.measurement import PlateFits, SizedPatches, fit_patches
from app.vision.parts_in_sight import PartOptions, fit_covered, fit_in_sight
from app.vision.patches import Pyramid, take_patches
from app.vision.proposals import ProposalOptions, promising
from app.vision.reading import CodeBook, MeasuredPlates, ReadingOptions, Strictness, read_plates
from app.vision.settling import SettlingOptions, settle_dots, settled_covariances, settled_plates
from app.vision.template import PatchGrid

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

# Changes whenever the same photograph could give other numbers: stored detections are kept by it.
DETECTOR_VERSION = "plate-9"


@dataclass(frozen=True)
class DetectorOptions:
    """Settings of the whole chain.

    Attributes
    ----------
    strictness : str
        How much the code family may mend: ``strict`` nothing, ``normal`` one digit, ``eager`` two.
    least_focal_share : float
        Least focal length over the picture's longer side: ultra-wide lenses of phones (13 mm) have 0.36.
    blur_px : float
        Blur (standard deviation) assumed at first sight.
    blurs_px : tuple of float
        Blurs that are tried; the one that puts the dots best on their grids is taken for the photograph.
    blur_plates : int
        Plates that the choice is made on.
    unexplained_ratio_max : float
        A blur that leaves this multiple of the least variance unexplained is not taken: the sharpest photographs are
        measured best at up to twice the least, while at ten times it green dots were read as black.
    misfit_slack : float
        The least blur whose misfit is within this multiple of the least is taken: a few plates tell no smaller
        difference, and under too soft a template the inks of small dots run into each other.
    """

    strictness: Strictness = "normal"
    least_focal_share: float = 0.35
    blur_px: float = 0.7
    blurs_px: tuple[float, ...] = (0.5, 0.9, 1.3, 1.9)
    blur_plates: int = 5
    unexplained_ratio_max: float = 3.0
    misfit_slack: float = 1.2
    dots: DotOptions = field(default_factory=DotOptions)
    grouping: GroupingOptions = field(default_factory=GroupingOptions)
    hidden_dots: HiddenDotOptions = field(default_factory=HiddenDotOptions)
    hidden_sides: HiddenSideOptions = field(default_factory=HiddenSideOptions)
    proposals: ProposalOptions = field(default_factory=ProposalOptions)
    centres: CentreOptions = field(default_factory=CentreOptions)
    settling: SettlingOptions = field(default_factory=SettlingOptions)
    inks: InkOptions = field(default_factory=InkOptions)
    judgement: JudgementOptions = field(default_factory=JudgementOptions)
    covering: CoveringOptions = field(default_factory=CoveringOptions)
    parts: PartOptions = field(default_factory=PartOptions)
    reading: ReadingOptions = field(default_factory=ReadingOptions)


def detect(
    bgr: Pixels,
    family: CodeFamily,
    options: DetectorOptions = DetectorOptions(),
    known_codes: frozenset[int] | None = None,
) -> Detection:
    """Find, measure and read all targets in a photograph.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
        Pixels as the sensor's rows lie.
    family : CodeFamily
        The site's codes.
    options : DetectorOptions
    known_codes : frozenset of int, optional
        The codes that the site holds: a mended code must be among them. Unmended codes are reported all the same.

    Returns
    -------
    Detection
        Targets with unique codes, and what was refused with its reason.
    """
    height_px, width_px = bgr.shape[:2]
    bgr = np.require(bgr, np.uint8, ("C", "W"))  # compiled loops take arrays of one kind
    first = _candidates(bgr, options)
    if not len(first.px_per_u):
        return Detection(width_px, height_px, ())
    plates = _measure(bgr, first, options)
    targets, rejected = read_plates(plates, CodeBook(family, options.strictness, known_codes), options.reading)
    return Detection(width_px, height_px, targets, rejected)


def _candidates(bgr: Pixels, options: DetectorOptions) -> PlateFits:
    """Whatever may be a plate, at first sight; none shares a dot with one that fits better."""
    blobs = find_red_blobs(bgr, options.dots)
    whole = len(blobs)
    least_focal_px = options.least_focal_share * max(bgr.shape[:2])
    groups = promising(bgr, blobs, group_base_dots(blobs, least_focal_px, options.grouping), options.proposals)
    fits = _first_look(bgr, blobs, groups, options)
    # Five dots of several plates may pass for a group, but not keep their dots from a plate with a hidden one.
    free = _free_blobs(whole, groups, fits, options.judgement)
    blobs, completed = complete_groups(blobs, free, options.hidden_dots)
    completed = promising(bgr, blobs, completed, options.proposals)
    fits = PlateFits.joined([fits, _first_look(bgr, blobs, completed, options)])
    groups = np.concatenate([groups, completed])
    kept = one_dot_one_target(groups, fits.explained())
    fits, groups = fits.select(kept), groups[kept]
    free = _free_blobs(whole, groups, fits, options.judgement)
    return PlateFits.joined([fits, _half_hidden(bgr, blobs, free, options)])


def _free_blobs(
    count: int, groups: npt.NDArray[np.intp], fits: PlateFits, options: JudgementOptions
) -> npt.NDArray[np.intp]:
    """Those of the first blobs that belong to no group that looks like a plate, strongest first."""
    claimed = groups[fits.explained() > options.explained_min]
    free = np.ones(count, dtype=np.bool_)
    free[claimed[claimed < count]] = False  # behind them stand dots that are made up
    return np.flatnonzero(free)


def _half_hidden(bgr: Pixels, blobs: Blobs, free: npt.NDArray[np.intp], options: DetectorOptions) -> PlateFits:
    """Plates of which a side is covered with both its corner dots, at first sight, from blobs of no other plate."""
    parts = options.parts.reading(options.inks, options.centres).at_first_sight()
    groups, sides = behind_sides(bgr, blobs, free, options.hidden_sides, parts.sides)
    found, visible = fit_covered(Pyramid.of(bgr, 1), sides, options.blur_px, parts)
    if len(found) < 2:
        return visible.fits
    return visible.fits.select(one_dot_one_target(groups[found], visible.fits.explained()))


def _first_look(bgr: Pixels, blobs: Blobs, groups: npt.NDArray[np.intp], options: DetectorOptions) -> PlateFits:
    """Rough fits: single pixels of the full photograph tell colours and places well enough."""
    image_from_plate = image_from_corner_dots(blobs.centres_px[groups[:, :4]])
    patches = take_patches(Pyramid.of(bgr, 1), image_from_plate, PatchGrid.ROUGH)
    return fit_patches(patches, np.full(len(groups), options.blur_px))


def _measure(bgr: Pixels, first: PlateFits, options: DetectorOptions) -> MeasuredPlates:
    """Fit all candidates again from the places that the first look found, and judge them."""
    size_px = (bgr.shape[1], bgr.shape[0])
    refined = _refined(first, size_px, options)
    pyramid = _pyramid(bgr, first, options)
    patches = SizedPatches.of(pyramid, refined)
    blur_px = _choose_blur(patches, size_px, options)
    in_sight = options.parts.reading(options.inks, options.centres)
    parts = fit_in_sight(pyramid, patches.fit(blur_px), (refined, first.image_from_plate), blur_px, in_sight)
    fits = parts.fits
    inks = read_inks(fits.amplitudes, options.inks).behind(parts.hidden, parts.cut)
    dots = locate_dots(fits, inks, size_px, options.centres)
    dots = settle_dots(bgr, fits, weigh_by_ink(fits, dots), blur_px, options.settling)
    refined = refine_homographies(fits, dots)
    judgement = judge_plates(fits, dots, inks, refined, options.judgement)
    lacking = judgement.lacks_red & (dots.inside & ~inks.hidden)[:, list(BASE_CELLS)]
    suspects = np.flatnonzero(judgement.stands & lacking.any(axis=1))
    if len(suspects):
        # A hidden base dot is forgiven, a missing one is not.
        covered = covered_base_dots(bgr, fits.select(suspects), refined[suspects], options.covering)
        missing = suspects[(lacking[suspects] & ~covered).any(axis=1)]
        judgement = judgement.refuse(missing, "base-dot-missing")
    settled, allowances = settled_plates(fits, options.settling), (options.centres, options.settling)
    covariances_px2 = settled_covariances(dots, refined, judgement.stands, settled, allowances)
    return MeasuredPlates(fits, dots, covariances_px2, inks, judgement)


def _refined(fits: PlateFits, size_px: tuple[int, int], options: DetectorOptions) -> Array:
    """Homographies through the dots as a fit has found them."""
    inks = read_inks(fits.amplitudes, options.inks)
    return refine_homographies(fits, locate_dots(fits, inks, size_px, options.centres))


def _choose_blur(patches: SizedPatches, size_px: tuple[int, int], options: DetectorOptions) -> float:
    """The blur under which the dots of a few plates lie best on their grids: all plates share one lens and focus."""
    fits = patches.fit_some(options.blur_plates, options.blurs_px)
    dots = locate_dots(fits, read_inks(fits.amplitudes, options.inks), size_px, options.centres)
    by_blur = (len(options.blurs_px), -1)
    misfit = _medians(misfit_px(dots, refine_homographies(fits, dots)).reshape(by_blur))
    unexplained = 1.0 - _medians(fits.explained().reshape(by_blur))
    # Dots of a picture too blurred for the template may lie well on their grids, and yet have lost their colours.
    misfit[unexplained > options.unexplained_ratio_max * unexplained.min()] = np.inf
    return options.blurs_px[int(np.argmax(misfit <= options.misfit_slack * misfit.min()))]


def _medians(rows: Array) -> Array:
    """Of each row; ``np.median`` takes ten times as long for a handful."""
    ordered, count = np.sort(rows, axis=1), rows.shape[1]
    middle: Array = 0.5 * (ordered[:, (count - 1) // 2] + ordered[:, count // 2])
    return middle


def _pyramid(bgr: Pixels, first: PlateFits, options: DetectorOptions) -> Pyramid:
    """As many halvings as the largest plate needs; what does not look like a plate needs none."""
    likely = first.explained() > options.judgement.explained_min
    largest = float(first.px_per_u[likely].max(initial=1.0))
    return Pyramid.of(bgr, 1 + int(np.ceil(np.log2(max(largest / PatchGrid.DENSE.px_per_u_max, 1.0)))))
