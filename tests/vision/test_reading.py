from dataclasses import replace

import numpy as np
import pytest

from app.geometry.observations import Rejected, TargetObservation
from app.targets.digits import digits_of_code
from app.targets.family import UNDECODABLE, CodeFamily
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.centres import locate_dots
from app.vision.inks import InkReading, read_inks
from app.vision.judgement import REASON_TEXT, Judgement
from app.vision.kernels.inkwell import HIDDEN_DIGIT
from app.vision.measurement import SizedPatches
from app.vision.patches import Pyramid
from app.vision.reading import CodeBook, MeasuredPlates, ReadingOptions, Strictness, read_plates
from tests.vision.scenes import Shot, true_homographies

PLATE = 5  # the one that a test changes
DIGITS = list(DIGIT_CELLS)
Read = tuple[dict[int, TargetObservation], tuple[Rejected, ...]]


@pytest.fixture(scope="module")
def plates(plates_shot: Shot) -> MeasuredPlates:
    """All 24, measured through their true homographies, none refused."""
    fits = SizedPatches.of(Pyramid.of(plates_shot.bgr, 1), true_homographies(plates_shot)).fit(0.9)
    inks = read_inks(fits.amplitudes)
    dots = locate_dots(fits, inks, (640, 480))
    covariances_px2 = np.broadcast_to(0.01 * np.eye(2), (24, 16, 2, 2))
    return MeasuredPlates(
        fits, dots, covariances_px2, inks, Judgement(("",) * 24, np.full(24, 0.1), np.zeros((24, 5), dtype=bool))
    )


def read(
    plates: MeasuredPlates,
    family: CodeFamily,
    strictness: Strictness = "normal",
    known_codes: frozenset[int] | None = None,
) -> Read:
    targets, rejected = read_plates(plates, CodeBook(family, strictness, known_codes))
    return {target.code: target for target in targets}, rejected


def with_inks(plates: MeasuredPlates, **changes: np.ndarray) -> MeasuredPlates:
    inks: InkReading = replace(plates.inks, **changes)
    return replace(plates, inks=inks)


def unsure(plates: MeasuredPlates, count: int) -> MeasuredPlates:
    """The first digits of one plate stand near a border between two inks."""
    confidence = plates.inks.confidence.copy()
    confidence[PLATE, :count] = 0.1
    return with_inks(plates, confidence=confidence)


def misread(plates: MeasuredPlates, count: int) -> MeasuredPlates:
    digits = plates.inks.digits.copy()
    digits[PLATE, -count:] = (digits[PLATE, -count:] + 1) % 3
    return with_inks(plates, digits=digits)


def test_plates_are_read_with_what_was_measured(plates: MeasuredPlates, plates_shot: Shot, family: CodeFamily) -> None:
    targets, rejected = read(plates, family)
    assert not rejected
    assert set(targets) == {target.code for target in plates_shot.truth}
    for plate, truth in enumerate(plates_shot.truth):
        target = targets[truth.code]
        np.testing.assert_array_equal(target.centres_px, plates.dots.centres_px[plate])
        np.testing.assert_array_equal(target.measured, plates.dots.measured[plate])
        assert (target.corrected, target.erased, target.rms_px) == (0, 0, 0.1)


@pytest.mark.parametrize("hidden", [1, 2, 4])
def test_unsure_digits_are_filled_and_their_dots_not_measured(
    plates: MeasuredPlates, plates_shot: Shot, family: CodeFamily, hidden: int
) -> None:
    targets, rejected = read(unsure(plates, hidden), family)
    target = targets[plates_shot.truth[PLATE].code]
    assert not rejected and (target.corrected, target.erased) == (0, hidden)
    assert not target.measured[DIGITS[:hidden]].any()


def test_without_a_digit_to_check_each_must_be_sure(
    plates: MeasuredPlates, plates_shot: Shot, family: CodeFamily
) -> None:
    """Four of eleven filled: one misread among the other seven gives another code of the family."""
    code = plates_shot.truth[PLATE].code
    for hidden, expected in ((3, True), (4, False)):
        doubtful = unsure(plates, hidden)
        doubtful.inks.confidence[PLATE, -1] = 0.5
        targets, rejected = read(doubtful, family)
        assert (code in targets) is expected
        assert [refusal.reason for refusal in rejected] == ["unreadable"] * (not expected)


def test_more_hidden_digits_than_the_family_fills_are_unreadable(plates: MeasuredPlates, family: CodeFamily) -> None:
    targets, (refusal,) = read(unsure(plates, 5), family)
    assert refusal.reason == "unreadable" and len(targets) == 23
    np.testing.assert_allclose(refusal.centre_px, plates.dots.centres_px[PLATE][list(BASE_CELLS[:4])].mean(axis=0))
    assert refusal.detail == REASON_TEXT["unreadable"] and refusal.code is None


@pytest.mark.parametrize(
    ("strictness", "wrong", "reason"),
    [
        ("strict", 1, "code-not-in-family"),
        ("normal", 1, ""),
        ("normal", 2, "code-not-in-family"),
        ("eager", 2, ""),
    ],
)
def test_wrong_digits_are_mended_as_far_as_strictness_goes(
    plates: MeasuredPlates, plates_shot: Shot, family: CodeFamily, strictness: Strictness, wrong: int, reason: str
) -> None:
    site = frozenset(target.code for target in plates_shot.truth)
    targets, rejected = read(misread(plates, wrong), family, strictness, site)
    assert [refusal.reason for refusal in rejected] == [reason] * bool(reason)
    if not reason:
        target = targets[plates_shot.truth[PLATE].code]
        assert target.corrected == wrong
        assert not target.measured[DIGITS[-wrong:]].any()  # a dot that says another thing has another thing's centre


def test_two_sure_digits_are_mended_by_a_list_alone(plates: MeasuredPlates, family: CodeFamily) -> None:
    """Every word lies within two digits of a golay code, as its mirror image does: it may be either's."""
    targets, (refusal,) = read(misread(plates, 2), family, "eager")
    assert refusal.reason == "mirror-image" and len(targets) == 23


def test_a_word_partly_hidden_and_partly_wrong_is_for_the_eager(plates: MeasuredPlates, family: CodeFamily) -> None:
    both = misread(unsure(plates, 1), 1)
    assert [refusal.reason for refusal in read(both, family)[1]] == ["unreadable"]
    targets, rejected = read(both, family, "eager")
    assert not rejected and any((t.corrected, t.erased) == (1, 1) for t in targets.values())


def test_dots_outside_the_photograph_are_hidden_whatever_they_show(
    plates: MeasuredPlates, plates_shot: Shot, family: CodeFamily
) -> None:
    inside = plates.dots.inside.copy()
    inside[PLATE, DIGITS[:3]] = False
    targets, _ = read(replace(plates, dots=replace(plates.dots, inside=inside)), family)
    assert targets[plates_shot.truth[PLATE].code].erased == 3


def test_of_equal_codes_the_better_fit_stands(plates: MeasuredPlates, family: CodeFamily) -> None:
    digits, residual_rms = plates.inks.digits.copy(), plates.fits.residual_rms.copy()
    digits[PLATE] = digits[PLATE + 1]
    residual_rms[PLATE] *= 1.5
    worse = replace(with_inks(plates, digits=digits), fits=replace(plates.fits, residual_rms=residual_rms))
    targets, (double,) = read(worse, family)
    code = int(family.decode(digits[PLATE], 0).code)  # type: ignore[union-attr]
    assert (double.reason, double.code) == ("duplicate-code", code)
    np.testing.assert_array_equal(targets[code].centres_px, plates.dots.centres_px[PLATE + 1])
    np.testing.assert_array_equal(double.corners_px, plates.dots.centres_px[PLATE][list(BASE_CELLS[:4])])


def test_what_was_refused_stays_refused_and_what_is_hardly_a_plate_is_not_told(
    plates: MeasuredPlates, family: CodeFamily
) -> None:
    reasons = ["", "wrong-layout", "not-red", "not-red", *[""] * 20]
    residual_rms = plates.fits.residual_rms.copy()
    residual_rms[3] = plates.fits.spread_rms[3]  # explains nothing
    judged = replace(
        plates,
        judgement=replace(plates.judgement, reasons=tuple(reasons)),
        fits=replace(plates.fits, residual_rms=residual_rms),
    )
    targets, rejected = read(judged, family)
    assert len(targets) == 21
    assert sorted(refusal.reason for refusal in rejected) == ["not-red", "wrong-layout"]


@pytest.mark.parametrize(
    ("strictness", "known", "word", "objection"),
    [
        ("normal", None, (UNDECODABLE, 0, 0), "code-not-in-family"),
        ("normal", None, (389, 1, 0), ""),
        ("normal", frozenset({389}), (389, 1, 0), ""),
        ("normal", frozenset({390}), (389, 1, 0), "code-not-in-family"),
        ("normal", frozenset({390}), (389, 0, 0), ""),
        ("normal", None, (389, 1, 1), "unreadable"),
        ("eager", None, (389, 1, 1), ""),
        ("eager", frozenset({390}), (389, 2, 0), "code-not-in-family"),
    ],
)
def test_objections_to_a_word(
    family: CodeFamily,
    strictness: Strictness,
    known: frozenset[int] | None,
    word: tuple[int, int, int],
    objection: str,
) -> None:
    assert CodeBook(family, strictness, known).objection(*word) == objection


def test_what_each_strictness_mends() -> None:
    assert [ReadingOptions().max_corrections(strictness) for strictness in ("strict", "normal", "eager")] == [0, 1, 2]


def test_hidden_is_no_digit(plates: MeasuredPlates, plates_shot: Shot) -> None:
    assert HIDDEN_DIGIT < 0
    np.testing.assert_array_equal(plates.inks.digits[PLATE], digits_of_code(plates_shot.truth[PLATE].code))
