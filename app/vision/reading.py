"""From measured plates to targets: digits to codes, one target per code, and a reason for whatever is refused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.observations import Rejected, TargetObservation
from app.geometry.plate_sigmas import PlateSigmas
from app.targets.digits import Codes, Digits, digits_of_codes
from app.targets.family import UNDECODABLE, CodeFamily
from app.targets.layout import BASE_CELLS, DIGIT_CELLS, DOT_COUNT
from app.vision.centres import DotCentres
from app.vision.evidence import DIGITS_IN_MIRROR, SeenWord
from app.vision.inks import InkReading
from app.vision.judgement import COLOUR_REASONS, REASON_TEXT, Judgement
from app.vision.kernels.inkwell import HIDDEN_DIGIT
from app.vision.measurement import PlateFits

Strictness = Literal["strict", "normal", "eager"]
DIGITS = list(DIGIT_CELLS)


@dataclass(frozen=True)
class ReadingOptions:
    """How digits become a code.

    Attributes
    ----------
    confidence_min : float
        A digit nearer than this to the border between two inks is taken as hidden (1 is a typical distance).
    sure_min : float
        Where hidden digits leave the family nothing to check, each digit that was read must be this sure: one misread
        then gives another code. Digits of blurred plates that were misread had up to 0.7.
    rival_margin : float
        By how much more another word must be contradicted than a mended one: of 171 plates that were mended rightly two
        have another so near, of those in a mirror nearly all.
    report_explained_min : float
        Groups that fail on colour are reported only if the plate's model explains this much of them: half.
    plate_sigmas : PlateSigmas
        How much of their errors a plate's dots share, as ``python -m benchmarks.plate_errors ROOM`` finds it.
    """

    confidence_min: float = 0.35
    sure_min: float = 0.7
    rival_margin: float = 0.25
    report_explained_min: float = 0.5
    plate_sigmas: PlateSigmas = PlateSigmas(shift=1.3, linear=1.2, dots=0.85)

    def max_corrections(self, strictness: Strictness) -> int:
        """Misread digits that may be mended: none, one (then two or three wrong are still refused), or two."""
        return {"strict": 0, "normal": 1, "eager": 2}[strictness]


@dataclass(frozen=True)
class MeasuredPlates:
    """Candidates of one photograph, measured and judged, before their codes are read; P of each.

    Attributes
    ----------
    fits : PlateFits
    dots : DotCentres
    covariances_px2 : ndarray of shape (P, 16, 2, 2)
        Of the dots' centres.
    inks : InkReading
    judgement : Judgement
    """

    fits: PlateFits
    dots: DotCentres
    covariances_px2: npt.NDArray[np.float64]
    inks: InkReading
    judgement: Judgement


@dataclass(frozen=True)
class CodeBook:
    """Which codes are believed.

    Attributes
    ----------
    family : CodeFamily
    strictness : str
        ``strict`` mends no digit, ``normal`` one, ``eager`` two; ``normal`` does not both mend and fill.
    known_codes : frozenset of int or None
        The codes that the site holds: a mended code must be among them. Unmended ones are reported all the same.
    """

    family: CodeFamily
    strictness: Strictness
    known_codes: frozenset[int] | None

    def objection(self, code: int, corrected: int, erased: int) -> str:
        """Why a decoded word is not believed; empty when it is."""
        if code == UNDECODABLE:
            return "code-not-in-family"
        if corrected and self.known_codes is not None and code not in self.known_codes:
            return "code-not-in-family"
        # A word that is partly hidden and partly wrong is near to many codes.
        if corrected and erased and self.strictness != "eager":
            return "unreadable"
        return ""

    def sees_mirror(self, digits: Digits, code: int) -> bool:
        """Whether a word that the site does not hold is, in a mirror, one that it does; ``digits`` as read, (11,)."""
        if self.known_codes is None or code in self.known_codes:
            return False
        mirrored = self.family.decode(digits[DIGITS_IN_MIRROR], 0)
        return mirrored is not None and mirrored.code in self.known_codes


def read_plates(
    plates: MeasuredPlates, book: CodeBook, options: ReadingOptions = ReadingOptions()
) -> tuple[tuple[TargetObservation, ...], tuple[Rejected, ...]]:
    """Targets and refusals; of two plates with one code the better fit stands and the other is reported."""
    digits = np.where(plates.inks.confidence < options.confidence_min, HIDDEN_DIGIT, plates.inks.digits)
    # A dot outside the photograph is hidden, whatever its border pixels look like.
    digits = np.where(plates.dots.inside[:, DIGITS], digits, HIDDEN_DIGIT).astype(np.int8)
    hidden = (digits == HIDDEN_DIGIT).sum(axis=1)
    decoded = np.stack(book.family.decode_many(digits, options.max_corrections(book.strictness)), axis=1)
    least_sure = np.where(digits == HIDDEN_DIGIT, np.inf, plates.inks.confidence).min(axis=1)
    unchecked = (hidden > 0) & (hidden >= book.family.distance - 1) & (least_sure < options.sure_min)
    measured = list(plates.dots.measured & _show_their_ink(decoded[:, 0], digits))
    explained = plates.fits.explained()
    reasons = plates.judgement.reasons
    spoilt, unsure = (hidden >= book.family.distance).tolist(), unchecked.tolist()
    reported = (explained > options.report_explained_min).tolist()
    words: list[list[int]] = decoded.tolist()
    half_hidden = (plates.inks.hidden[:, list(BASE_CELLS)].sum(axis=1) > 1).tolist()
    targets: dict[int, TargetObservation] = {}
    rejected: list[Rejected] = []
    for plate in np.argsort(-explained, kind="stable").tolist():
        code, corrected, erased = words[plate]
        reason = reasons[plate] or book.objection(code, corrected, erased)
        if reason == "code-not-in-family" and spoilt[plate]:
            reason = "unreadable"
        # With two corners hidden a plate is less sure, and must say its code as it stands.
        if not reason and (unsure[plate] or (half_hidden[plate] and corrected)):
            reason = "unreadable"
        if not reason and book.sees_mirror(digits[plate], code):
            reason = "mirror-image"
        if not reason and (corrected or erased):
            reason = _word(plates, plate).rival(code, book.family, book.known_codes, options.rival_margin)
        if not reason and code in targets:
            reason = "duplicate-code"
        if not reason:
            targets[code] = _target(plates, plate, words[plate], measured[plate], options.plate_sigmas)
        elif reason not in COLOUR_REASONS or reported[plate]:
            rejected.append(_rejected(plates, plate, reason, code if reason == "duplicate-code" else None))
    return tuple(targets.values()), tuple(rejected)


def _word(plates: MeasuredPlates, plate: int) -> SeenWord:
    """What a plate's digits look like, the doubtful ones, too."""
    inside = plates.dots.inside[plate, DIGITS]
    return SeenWord(np.where(inside, plates.inks.digits[plate], HIDDEN_DIGIT), plates.inks.confidence[plate])


def _show_their_ink(codes: Codes, digits: npt.NDArray[np.int8]) -> npt.NDArray[np.bool_]:
    """Which dots look as the code says, shape (P, 16): what covers a hidden or mended one has a centre of its own."""
    shows = np.ones((len(codes), DOT_COUNT), dtype=np.bool_)
    shows[:, DIGITS] = digits == digits_of_codes(np.maximum(codes, 0))
    return shows


def _target(
    plates: MeasuredPlates, plate: int, word: list[int], measured: npt.NDArray[np.bool_], shared: PlateSigmas
) -> TargetObservation:
    code, corrected, erased = word
    return TargetObservation(
        code=code,
        centres_px=plates.dots.centres_px[plate],
        covariances_px2=plates.covariances_px2[plate],
        measured=measured,
        corrected=corrected,
        erased=erased,
        rms_px=float(plates.judgement.rms_px[plate]),
        plate_sigmas=shared,
    )


def _rejected(plates: MeasuredPlates, plate: int, reason: str, code: int | None) -> Rejected:
    corners_px: npt.NDArray[np.float64] = plates.dots.centres_px[plate][list(BASE_CELLS[:4])]
    return Rejected(reason, corners_px.mean(axis=0), REASON_TEXT[reason], code, corners_px)
