"""The published method to the letter: the baseline of every comparison.

    photo -> red channel, Canny, ellipses -> groups of five -> colours of the other eleven -> code

Source: Sensors 2019, "Smartphone Indoor Positioning Dynamic Ground Truth Reference System Using Robust Visual Encoded
Targets", section 3; the design's pipeline.md, section 1. It knows no erasures and no corrections: with a family that
protects its codes, a misread dot makes the code unreadable instead of wrong.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from app.geometry.observations import Detection, Rejected, TargetObservation
from app.targets.digits import BLACK, ERASED, GREEN, WHITE
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS, DIGIT_CELLS, DOT_COUNT, DOT_RADIUS_U
from app.vision.homography import PLATE_DOTS_U, apply_homographies, area_scales, fit_homographies, homography_jacobians
from app.vision.paper_ellipses import EllipseOptions, find_ellipses
from app.vision.paper_groups import GroupOptions, group_base_dots

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

# Changes whenever the same photograph could give other numbers: stored detections are kept by it.
PAPER_VERSION = "paper-1"

BASE, DIGITS = list(BASE_CELLS), list(DIGIT_CELLS)
FULL_SCALE = 255.0


@dataclass(frozen=True)
class ColourOptions:
    """The paper's colour rule, on channels stretched to 0 ... 255 over the target.

    Attributes
    ----------
    black_below : float
        All three channels below: black.
    green_above, green_lead : float
        Green above, and so far above the other two: green.
    white_above, white_spread : float
        All above, and within so much of each other: white.
    sample_radius_u : float
        A dot's colour is the mean over this radius: half of the dot keeps off its blurred edge.
    """

    black_below: float = 50.0
    green_above: float = 100.0
    green_lead: float = 50.0
    white_above: float = 150.0
    white_spread: float = 50.0
    sample_radius_u: float = DOT_RADIUS_U / 2


@dataclass(frozen=True)
class PaperOptions:
    """Settings of the published method.

    Attributes
    ----------
    sigma_px : float
        Standard deviation of an ellipse's centre, per coordinate: measured as 0.12 on synthetic photographs of
        640 x 480 (2.5 ... 7 px per u), 0.17 on rendered ones of a dim room.
    """

    sigma_px: float = 0.15
    ellipses: EllipseOptions = field(default_factory=EllipseOptions)
    groups: GroupOptions = field(default_factory=GroupOptions)
    colours: ColourOptions = field(default_factory=ColourOptions)


def detect_paper(bgr: Pixels, family: CodeFamily, options: PaperOptions = PaperOptions()) -> Detection:
    """Find and read all targets in a photograph as the paper does.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    family : CodeFamily
        ``full`` is the paper's own choice.
    options : PaperOptions

    Returns
    -------
    Detection
        Only base dots are measured; the others are where the plate's homography puts them.
    """
    ellipses = find_ellipses(bgr, options.ellipses)
    groups, refused = group_base_dots(ellipses, options.groups)
    centres_px = np.array([ellipse.centre_px for ellipse in ellipses]).reshape(-1, 2)
    targets: dict[int, TargetObservation] = {}
    rejected = [_rejected("not-a-target", "no arrangement of the five fits a target", centres_px[r]) for r in refused]
    for group in groups:
        outcome = _read(bgr, centres_px[group], family, options)
        if isinstance(outcome, TargetObservation) and outcome.code in targets:
            text = f"code {outcome.code} is read twice in this photograph; the better fit is kept"
            outcome, targets[outcome.code] = _worse_and_better(outcome, targets[outcome.code])
            rejected.append(_rejected("duplicate-code", text, outcome.centres_px[BASE]))
        elif isinstance(outcome, TargetObservation):
            targets[outcome.code] = outcome
        else:
            rejected.append(outcome)
    return Detection(bgr.shape[1], bgr.shape[0], tuple(targets.values()), tuple(rejected))


def _read(bgr: Pixels, base_px: Array, family: CodeFamily, options: PaperOptions) -> TargetObservation | Rejected:
    """The target of five base dots, A ... E, shape (5, 2)."""
    image_from_plate = fit_homographies(PLATE_DOTS_U[BASE], base_px[None], np.ones((1, len(BASE))))
    centres_px = apply_homographies(image_from_plate, PLATE_DOTS_U)[0]
    radius_px = options.colours.sample_radius_u * area_scales(homography_jacobians(image_from_plate, PLATE_DOTS_U))[0]
    digits = read_digits(stretch(bgr, base_px[:4], centres_px, radius_px)[DIGITS], options.colours)
    if (digits == ERASED).any():
        return _rejected("unclear-colour", "a dot is neither black nor green nor white", base_px)
    decoded = family.decode(digits, max_corrections=0)
    if decoded is None:
        return _rejected("code-not-in-family", f"the colours read are no code of family {family.name}", base_px)
    measured = np.isin(np.arange(DOT_COUNT), BASE)
    # The fit's residuals before the measured centres take their places.
    residuals_px = centres_px[BASE] - base_px
    centres_px[BASE] = base_px
    covariances_px2 = np.broadcast_to(options.sigma_px**2 * np.eye(2), (DOT_COUNT, 2, 2)).copy()
    rms_px = float(np.sqrt(np.mean(residuals_px**2)))
    return TargetObservation(decoded.code, centres_px, covariances_px2, measured, rms_px=rms_px)


def stretch(bgr: Pixels, corners_px: Array, centres_px: Array, radius_px: Array) -> Array:
    """Mean colour of each dot, shape (16, 3), B G R, each channel stretched by its least and greatest value.

    The extremes are those over the quadrilateral of the base dots: over the red dots alone, green and blue would
    saturate.
    """
    reach_px = float(radius_px.max()) + 1.0
    first = np.maximum(np.floor(centres_px.min(axis=0) - reach_px), 0).astype(int)
    last = np.ceil(centres_px.max(axis=0) + reach_px).astype(int) + 1
    patch = bgr[first[1] : last[1], first[0] : last[0]].astype(np.float64)
    inside = cv2.fillConvexPoly(
        np.zeros(patch.shape[:2], dtype=np.uint8), np.rint(corners_px - first).astype(np.int32), 1
    )
    least, greatest = patch[inside > 0].min(axis=0), patch[inside > 0].max(axis=0)
    rows, columns = np.mgrid[0 : patch.shape[0], 0 : patch.shape[1]]
    colours = np.empty((DOT_COUNT, 3))
    for dot, (x_px, y_px) in enumerate(centres_px - first):
        away_px = np.hypot(columns - x_px, rows - y_px)
        # The nearest pixel stands in for a dot so small that no pixel's centre lies within the radius.
        colours[dot] = patch[away_px <= max(radius_px[dot], float(away_px.min()))].mean(axis=0)
    return (colours - least) / np.maximum(greatest - least, 1.0) * FULL_SCALE


def read_digits(colours_bgr: Array, options: ColourOptions) -> npt.NDArray[np.int8]:
    """Digits of stretched colours of shape (N, 3), shape (N,); -1 where the rule names none."""
    blue, green, red = colours_bgr.T
    black = (colours_bgr < options.black_below).all(axis=1)
    lead = green - np.maximum(blue, red)
    is_green = (green > options.green_above) & (lead > options.green_lead)
    spread = colours_bgr.max(axis=1) - colours_bgr.min(axis=1)
    white = (colours_bgr > options.white_above).all(axis=1) & (spread < options.white_spread)
    return np.select([black, is_green, white], [BLACK, GREEN, WHITE], ERASED).astype(np.int8)


def _worse_and_better(one: TargetObservation, other: TargetObservation) -> tuple[TargetObservation, TargetObservation]:
    return (one, other) if one.rms_px > other.rms_px else (other, one)


def _rejected(reason: str, detail: str, dots_px: Array) -> Rejected:
    return Rejected(reason, dots_px.mean(axis=0), detail, corners_px=dots_px)
