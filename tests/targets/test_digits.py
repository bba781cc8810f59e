import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.targets.digits import CODE_COUNT, DIGIT_COUNT, code_of_digits, codes_of_digits, digits_of_code, digits_of_codes


def test_published_example() -> None:
    assert digits_of_code(389).tolist() == [0, 0, 0, 0, 0, 1, 1, 2, 1, 0, 2]


def test_every_code_returns_from_its_digits() -> None:
    codes = np.arange(CODE_COUNT)
    digits = digits_of_codes(codes)
    assert digits.shape == (CODE_COUNT, DIGIT_COUNT) and digits.dtype == np.int8
    np.testing.assert_array_equal(codes_of_digits(digits), codes)


@given(st.lists(st.integers(0, 2), min_size=DIGIT_COUNT, max_size=DIGIT_COUNT))
def test_first_digit_is_the_most_significant(values: list[int]) -> None:
    assert code_of_digits(np.array(values, dtype=np.int8)) == int("".join(map(str, values)), 3)


@pytest.mark.parametrize("code", [-1, CODE_COUNT])
def test_codes_outside_the_range_are_refused(code: int) -> None:
    with pytest.raises(ValueError, match="lies within"):
        digits_of_code(code)


def test_erased_or_missing_digits_have_no_code() -> None:
    with pytest.raises(ValueError, match="fill the erased"):
        code_of_digits(np.array([0] * 10 + [-1], dtype=np.int8))
    with pytest.raises(ValueError, match="11 digits"):
        code_of_digits(np.zeros(10, dtype=np.int8))
