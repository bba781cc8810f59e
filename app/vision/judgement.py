"""Which fitted plates stand as targets, and why the others do not."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS
from app.vision.centres import DotCentres
from app.vision.homography import PLATE_DOTS_U
from app.vision.inks import InkReading
from app.vision.kernels import judging
from app.vision.kernels.claims import keep_apart
from app.vision.kernels.misfits import measure_misfits
from app.vision.measurement import PlateFits

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class JudgementOptions:
    """What a target must show. Each bound stands between what plates show and what marker-free photographs show.

    Attributes
    ----------
    red_min : float
        Red amplitude of every base dot, linear light of 255: a dim plate has 7 at a grey value of 60.
    red_over_residual : float
        The same over what the fit left unexplained: above noise.
    uneven_max : float
        Departure of a base dot's red from the plane through all five, over their mean.
    red_digit : tuple of float
        An identification dot is red when its red is at least this part of what a base dot would have there, and its
        green and blue at most this part of its own red: wrong structure.
    background_max : float
        The plate's black over the red amplitude: 0.3 in even light, 1.5 under a reflection.
    below_black_max : tuple of float
        Of a plate that is weakly explained, and of any: how far the base dots' green or blue may lie below the plate's
        black, mean of the five over the red amplitude. Ink has as little of both as black, whatever light a film
        mirrors on top; red dots on grey or green ground take 0.4 to 1.7 of it away.
    explained_min : float
        Part of the picture's variance that the plate's model explains.
    explained_surely : float
        Below, a plate is weakly explained: red dots on cloth and wall mostly reach 0.7 to 0.77.
    misfit_max_u : float
        Root mean square of the dots about the plate's homography: a tenth of a radius on flat plates.
    misfit_noise_px : float
        What noise adds to that on small plates.
    base_dots_min, dots_min : int
        Measured base dots, and measured dots in all.
    base_dots_covered_min : int
        Measured base dots of a plate that is known to be covered from a side: two corners may stand there.
    """

    red_min: float = 2.0
    red_over_residual: float = 1.5
    uneven_max: float = 0.8
    red_digit: tuple[float, float] = (0.6, 0.25)
    background_max: float = 2.0
    below_black_max: tuple[float, float] = (0.34, 1.0)
    explained_min: float = 0.7
    explained_surely: float = 0.82
    misfit_max_u: float = 0.15
    misfit_noise_px: float = 0.25
    base_dots_min: int = 4
    dots_min: int = 6
    base_dots_covered_min: int = 3

    def bounds(self) -> tuple[float, ...]:
        """As the compiled loop takes them: all in their order, pairs as two."""
        values = tuple(value if isinstance(value, tuple) else (value,) for value in vars(self).values())
        return tuple(float(bound) for value in values for bound in value)


@dataclass(frozen=True)
class Judgement:
    """Verdicts on P plates.

    Attributes
    ----------
    reasons : tuple of str
        Empty where the plate stands; else the first test that failed.
    rms_px : ndarray of shape (P,)
        Root mean square, per coordinate, of the measured dots about the plate's homography.
    lacks_red : ndarray of shape (P, 5), bool
        Base dots that do not show red, or no more of it than noise.
    """

    reasons: tuple[str, ...]
    rms_px: Array
    lacks_red: Mask

    @property
    def stands(self) -> Mask:
        """Which plates have no reason against them, shape (P,)."""
        return np.array([not reason for reason in self.reasons], dtype=np.bool_)

    def refuse(self, plates: npt.NDArray[np.intp], reason: str) -> Judgement:
        """The same judgement with a reason against some plates."""
        refused = {int(plate) for plate in plates}
        reasons = tuple(reason if plate in refused else before for plate, before in enumerate(self.reasons))
        return replace(self, reasons=reasons)


REASON_TEXT = {
    "not-red": "base dots are not red, or hardly brighter than the plate",
    "uneven-red": "the base dots differ in brightness",
    "bright-background": "there is no black between the dots",
    "not-a-plate": "the picture does not look like a plate",
    "base-dot-missing": "a base dot is missing where the plate is in plain view: wrong structure",
    "red-digit": "a dot is red that should say a digit: wrong structure",
    "wrong-layout": "the dots do not lie on the plate's grid: wrong structure, or bent paper",
    "too-few-dots": "too few dots could be measured",
    "outside-photo": "a base dot lies outside the photograph",
    "unreadable": "too many identification dots are hidden or unclear",
    "code-not-in-family": "the dots were read, but their code is not in the site's family",
    "mirror-image": "the dots say a code of the site only when seen in a mirror",
    "duplicate-code": "the same code was read better elsewhere in this photograph",
}

# Of the tests of a fitted plate, which are made in this order.
REASONS = {
    judging.STANDS: "",
    judging.OUTSIDE_PHOTO: "outside-photo",
    judging.NOT_RED: "not-red",
    judging.UNEVEN_RED: "uneven-red",
    judging.BRIGHT_BACKGROUND: "bright-background",
    judging.NOT_A_PLATE: "not-a-plate",
    judging.TOO_FEW_DOTS: "too-few-dots",
    judging.WRONG_LAYOUT: "wrong-layout",
    judging.RED_DIGIT: "red-digit",
}

# A group that fails one of these was hardly a plate at all.
COLOUR_REASONS = ("not-red", "uneven-red", "bright-background", "not-a-plate")


def judge_plates(
    fits: PlateFits, dots: DotCentres, inks: InkReading, refined: Array, options: JudgementOptions = JudgementOptions()
) -> Judgement:
    """Test fitted plates against what a target must show; the code is judged elsewhere.

    Parameters
    ----------
    refined : ndarray of shape (P, 3, 3)
        Homographies through the measured dots.
    """
    count = len(refined)
    verdicts, rms_px = np.empty(count, dtype=np.int64), np.empty(count)
    lacks_red = np.empty((count, len(BASE_CELLS)), dtype=np.bool_)
    fitted = (fits.amplitudes, fits.planes, fits.residual_rms, fits.px_per_u, fits.explained())
    located = (np.ascontiguousarray(dots.centres_px), np.ascontiguousarray(dots.measured), dots.inside)
    read = (inks.red_base, inks.red_level, inks.hidden, inks.cut)
    judging.judge_all(fitted, (refined, PLATE_DOTS_U, *located), read, options.bounds(), (verdicts, rms_px, lacks_red))
    return Judgement(tuple(REASONS[verdict] for verdict in verdicts.tolist()), rms_px, lacks_red)


def misfit_px(dots: DotCentres, image_from_plate: Array) -> Array:
    """Root mean square per coordinate of the measured dots about their homographies, shape (P,), px."""
    misfits_px = np.empty(len(image_from_plate))
    homographies, centres_px = np.ascontiguousarray(image_from_plate), np.ascontiguousarray(dots.centres_px)
    measure_misfits(homographies, PLATE_DOTS_U, centres_px, np.ascontiguousarray(dots.measured), misfits_px)
    return misfits_px


def one_dot_one_target(groups: npt.NDArray[np.intp], quality: Array) -> npt.NDArray[np.intp]:
    """Indices of the groups, best first, that share no blob with a better one.

    Parameters
    ----------
    groups : ndarray of shape (G, 5)
        Blob indices, -1 for a dot that was not seen.
    quality : ndarray of shape (G,)
    """
    kept = np.empty(len(groups), dtype=np.int64)
    order = np.argsort(-quality, kind="stable")
    count = keep_apart(np.ascontiguousarray(groups), order, kept)
    return kept[:count]
