import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.targets.digits import digits_of_code
from app.targets.family import CodeFamily, family_by_name
from app.vision.evidence import DIGITS_IN_MIRROR, SeenWord, words_of
from app.vision.kernels.inkwell import HIDDEN_DIGIT
from app.vision.reading import ReadingOptions

GOLAY = family_by_name("golay")
OWN_MIRROR = {88_573, 177_146}  # all green, all white
MARGIN = ReadingOptions().rival_margin
SURE, DOUBTFUL = 1.5, 0.4
CODES = st.sampled_from(GOLAY.codes.tolist())
TOLD_FROM_MIRROR = st.sampled_from([code for code in GOLAY.codes.tolist() if code not in OWN_MIRROR])


def seen(code: int, confidence: float = SURE) -> SeenWord:
    return SeenWord(digits_of_code(code), np.full(11, confidence))


def misread(word: SeenWord, places: list[int], confidence: float) -> SeenWord:
    """The same with other digits in some places, all of one confidence."""
    digits, confidences = word.digits.copy(), word.confidence.copy()
    digits[places] = (digits[places] + 1) % 3
    confidences[places] = confidence
    return SeenWord(digits, confidences)


@given(code=CODES)
def test_nothing_speaks_against_what_was_seen(code: int) -> None:
    word = seen(code)
    against = word.against(words_of(GOLAY))
    assert against[GOLAY.codes == code] == 0.0
    assert np.delete(against, np.flatnonzero(GOLAY.codes == code)).min() == GOLAY.distance  # sure is 1, never more
    assert word.rival(code, GOLAY, None, MARGIN) == ""


@given(code=CODES)
def test_a_mirror_exchanges_twice_to_nothing(code: int) -> None:
    np.testing.assert_array_equal(seen(code).in_mirror().in_mirror().digits, digits_of_code(code))


def test_two_golay_codes_are_their_own_image_in_a_mirror_and_no_other_shows_a_code() -> None:
    mirrored = words_of(GOLAY)[:, DIGITS_IN_MIRROR]
    same = [int(code) for code, word in zip(GOLAY.codes, mirrored, strict=True) if GOLAY.decode(word, 0) is not None]
    assert set(same) == OWN_MIRROR
    assert all((digits_of_code(code)[DIGITS_IN_MIRROR] == digits_of_code(code)).all() for code in same)


@given(code=CODES, place=st.integers(0, 10))
def test_one_doubtful_digit_is_mended_unless_its_mirror_image_lacks_that_one_as_well(code: int, place: int) -> None:
    word = misread(seen(code), [place], DOUBTFUL)
    elsewhere = np.arange(11) != place
    mirrored = words_of(GOLAY)[:, DIGITS_IN_MIRROR]
    ambiguous = (mirrored == word.digits)[:, elsewhere].all(axis=1).any()
    assert word.rival(code, GOLAY, None, MARGIN) == ("mirror-image" if ambiguous else "")
    # With a list an unlisted code in the mirror counts where it contradicts nothing at all.
    better = (mirrored == word.digits).all(axis=1).any()
    assert word.rival(code, GOLAY, frozenset({code}) - OWN_MIRROR, MARGIN) == ("mirror-image" if better else "")


@given(code=TOLD_FROM_MIRROR, place=st.integers(0, 10))
def test_a_plate_in_a_mirror_with_a_doubtful_digit_says_no_other_code(code: int, place: int) -> None:
    """Mended as it stands it would contradict sure digits, and as the mirror's word that doubtful one alone."""
    word = misread(seen(code), [place], DOUBTFUL).in_mirror()
    decoded = GOLAY.decode(word.digits, 2)
    if decoded is not None and decoded.corrected:
        assert word.rival(decoded.code, GOLAY, None, MARGIN) == "mirror-image"
        assert word.rival(decoded.code, GOLAY, frozenset({code}), MARGIN) == "mirror-image"
        sure = word.against(digits_of_code(decoded.code)[None])[0] >= 1.0
        # Where both contradict but the doubtful digit, the site's list decides.
        assert word.rival(decoded.code, GOLAY, frozenset({decoded.code}), MARGIN) == ("mirror-image" if sure else "")


def test_a_code_that_contradicts_more_than_another_is_not_believed() -> None:
    """Five digits between two codes: three doubtful ones misread, and two sure digits would be mended instead."""
    one, other = (
        389,
        next(int(code) for code in GOLAY.codes if (digits_of_code(int(code)) != digits_of_code(389)).sum() == 5),
    )
    apart = np.flatnonzero(digits_of_code(one) != digits_of_code(other))
    digits, confidence = digits_of_code(one), np.full(11, SURE)
    digits[apart[:3]], confidence[apart[:3]] = digits_of_code(other)[apart[:3]], DOUBTFUL
    word = SeenWord(digits, confidence)
    decoded = GOLAY.decode(digits, 2)
    assert decoded is not None and decoded.code == other
    assert word.rival(other, GOLAY, frozenset({one, other}), MARGIN)
    assert word.rival(one, GOLAY, frozenset({one, other}), MARGIN) == ""


@pytest.mark.parametrize("name", ["parity", "full"])
def test_families_whose_words_are_codes_in_a_mirror_too_are_not_asked_for_it(name: str) -> None:
    family: CodeFamily = family_by_name(name)
    code = int(family.codes[100])
    word = misread(seen(code), [3], 0.1)
    word.confidence[4] = 0.2
    assert word.rival(code, family, None, MARGIN) == "unreadable"  # the fourth may be right, and the fifth wrong


def test_what_is_hidden_speaks_against_nothing() -> None:
    word = seen(389)
    digits = word.digits.copy()
    digits[:4] = HIDDEN_DIGIT
    assert SeenWord(digits, word.confidence).rival(389, GOLAY, None, MARGIN) == ""
