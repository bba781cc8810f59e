import pickle
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import InvalidInput
from app.targets.digits import CODE_COUNT, DIGIT_COUNT, ERASED, digits_of_code, digits_of_codes
from app.targets.family import FAMILY_NAMES, UNDECODABLE, family_by_name

SIZES = {"golay": 729, "hamming": 6_561, "parity": 59_049, "full": 177_147}
DISTANCES = {"golay": 5, "hamming": 3, "parity": 2, "full": 1}
ALL_WORDS = digits_of_codes(np.arange(CODE_COUNT))


def least_weight(codes: np.ndarray) -> int:
    return int((digits_of_codes(codes) != 0).sum(axis=1).min())


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_size_distance_and_linearity(name: str) -> None:
    family = family_by_name(name)
    assert len(family.codes) == SIZES[name] - 1 and family.codes.dtype == np.int64
    assert (np.diff(family.codes) > 0).all() and family.codes[0] > 0
    assert least_weight(family.codes) == family.distance == DISTANCES[name]
    rng = np.random.default_rng(1)
    digits = digits_of_codes(rng.choice(family.codes, (200, 2)))
    sums = (digits[:, 0] + digits[:, 1]) % 3
    assert np.isin([int("".join(map(str, word)), 3) for word in sums.tolist()], np.append(family.codes, 0)).all()


def test_golay_weights_are_those_of_the_perfect_code() -> None:
    weights = (digits_of_codes(family_by_name("golay").codes) != 0).sum(axis=1)
    values, counts = np.unique(weights, return_counts=True)
    assert dict(zip(values.tolist(), counts.tolist(), strict=True)) == {5: 132, 6: 132, 8: 330, 9: 110, 11: 24}


def test_golay_is_cyclic_and_holds_its_generator() -> None:
    family = family_by_name("golay")
    generator = np.array([0, 0, 0, 0, 0, 1, 1, 2, 1, 0, 2])  # x^5 + x^4 - x^3 + x^2 - 1: the paper's code 389
    for shift in range(DIGIT_COUNT):
        assert family.contains(int("".join(map(str, np.roll(generator, shift))), 3))
    assert family.contains(389)


def test_golay_is_perfect_every_word_lies_within_two_dots_of_exactly_one_codeword() -> None:
    codes, corrected, _ = family_by_name("golay").decode_many(ALL_WORDS, max_corrections=2)
    around_zero = (ALL_WORDS != 0).sum(axis=1) <= 2
    np.testing.assert_array_equal(codes == UNDECODABLE, around_zero)
    read, words = codes[~around_zero], ALL_WORDS[~around_zero]
    np.testing.assert_array_equal((digits_of_codes(read) != words).sum(axis=1), corrected[~around_zero])
    # Spheres of equal size that together hold all words: no word is claimed twice.
    sphere = int(around_zero.sum())
    assert (np.unique(read, return_counts=True)[1] == sphere).all()
    assert sphere * SIZES["golay"] == CODE_COUNT


def test_hamming_reads_all_words_one_dot_from_a_codeword_and_no_other() -> None:
    family = family_by_name("hamming")
    codes, corrected, _ = family.decode_many(ALL_WORDS, max_corrections=1)
    readable = codes != UNDECODABLE
    distances = (digits_of_codes(codes[readable]) != ALL_WORDS[readable]).sum(axis=1)
    np.testing.assert_array_equal(distances, corrected[readable])
    assert distances.max() == 1
    # Eleven digits are two short of the perfect ternary Hamming code: the spheres do not meet, nor do they fill space.
    assert readable.sum() == len(family.codes) * (1 + 2 * DIGIT_COUNT)


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_without_corrections_only_codewords_are_read(name: str) -> None:
    family = family_by_name(name)
    codes, corrected, _ = family.decode_many(ALL_WORDS, max_corrections=0)
    np.testing.assert_array_equal(codes[codes != UNDECODABLE], family.codes)
    np.testing.assert_array_equal(np.flatnonzero(codes != UNDECODABLE), family.codes)
    assert not corrected.any()


def test_golay_with_one_correction_refuses_two_wrong_dots() -> None:
    family = family_by_name("golay")
    codes, corrected, _ = family.decode_many(ALL_WORDS, max_corrections=1)
    assert corrected.max() == 1
    assert (codes != UNDECODABLE).sum() == len(family.codes) * (1 + 2 * DIGIT_COUNT)


@pytest.mark.parametrize("name", ["parity", "full"])
def test_weak_families_correct_nothing(name: str) -> None:
    family = family_by_name(name)
    strict, eager = (family.decode_many(ALL_WORDS, max_corrections=allowed)[0] for allowed in (0, 2))
    np.testing.assert_array_equal(strict, eager)


def test_parity_codes_have_digit_sum_zero() -> None:
    family = family_by_name("parity")
    np.testing.assert_array_equal(np.flatnonzero(ALL_WORDS.sum(axis=1) % 3 == 0)[1:], family.codes)


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_every_erasure_pattern_within_the_distance_is_filled(name: str) -> None:
    family = family_by_name(name)
    sample = np.random.default_rng(2).choice(family.codes, 40)
    for hidden in combinations(range(DIGIT_COUNT), family.distance - 1):
        digits = digits_of_codes(sample)
        digits[:, list(hidden)] = ERASED
        codes, corrected, erased = family.decode_many(digits, max_corrections=2)
        np.testing.assert_array_equal(codes, sample)
        assert not corrected.any() and (erased == family.distance - 1).all()


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_one_hidden_dot_too_many_is_undecodable(name: str) -> None:
    family = family_by_name(name)
    digits = digits_of_codes(family.codes[:100])
    digits[:, : family.distance] = ERASED
    assert (family.decode_many(digits, max_corrections=2)[0] == UNDECODABLE).all()


@given(
    name=st.sampled_from(FAMILY_NAMES),
    index=st.integers(0, 727),
    places=st.permutations(range(DIGIT_COUNT)),
    hidden=st.integers(0, 5),
    wrong=st.integers(0, 3),
    allowed=st.integers(0, 3),
)
def test_a_word_is_mended_exactly_within_its_budget(
    name: str, index: int, places: list[int], hidden: int, wrong: int, allowed: int
) -> None:
    family = family_by_name(name)
    code = int(family.codes[index % len(family.codes)])
    digits = digits_of_code(code)
    digits[places[:hidden]] = ERASED
    digits[places[hidden : hidden + wrong]] = (digits[places[hidden : hidden + wrong]] + 1) % 3
    decoded = family.decode(digits, allowed)
    if 2 * wrong + hidden <= family.distance - 1 and wrong <= allowed:
        assert decoded is not None
        assert (decoded.code, decoded.corrected, decoded.erased) == (code, wrong, hidden)
    elif decoded is not None:  # too far from its own code, it may lie near another, but never beyond the budget
        assert 2 * decoded.corrected + decoded.erased <= family.distance - 1
        assert decoded.corrected <= allowed and family.contains(decoded.code)


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_the_black_plate_is_never_read(name: str) -> None:
    family = family_by_name(name)
    assert not family.contains(0) and 0 not in family.codes
    assert family.decode(np.zeros(DIGIT_COUNT, dtype=np.int8), 2) is None


def test_contains_agrees_with_the_list_and_knows_the_range() -> None:
    family = family_by_name("golay")
    members = [code for code in range(2_000) if family.contains(code)]
    assert members == family.codes[family.codes < 2_000].tolist()
    assert not family.contains(-1) and not family.contains(CODE_COUNT)


def test_no_words_are_no_codes() -> None:
    codes, corrected, erased = family_by_name("golay").decode_many(np.zeros((0, DIGIT_COUNT), dtype=np.int8), 1)
    assert codes.shape == corrected.shape == erased.shape == (0,)


def test_a_family_crosses_process_borders() -> None:
    family = family_by_name("golay")
    copy = pickle.loads(pickle.dumps(family))
    assert copy == family and copy.decode(digits_of_code(389), 0) == family.decode(digits_of_code(389), 0)


def test_misuse_is_named() -> None:
    family = family_by_name("golay")
    with pytest.raises(InvalidInput, match="golay, hamming, parity, full"):
        family_by_name("gray")
    with pytest.raises(ValueError, match="shape"):
        family.decode_many(np.zeros((3, 10), dtype=np.int8), 1)
    with pytest.raises(ValueError, match="hidden"):
        family.decode_many(np.full((1, DIGIT_COUNT), 3, dtype=np.int8), 1)
    with pytest.raises(ValueError, match="negative"):
        family.decode_many(np.zeros((1, DIGIT_COUNT), dtype=np.int8), -1)
