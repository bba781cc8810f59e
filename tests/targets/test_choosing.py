import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import InvalidInput
from app.targets.choosing import choose_codes
from app.targets.digits import digits_of_codes
from app.targets.family import family_by_name

GOLAY = family_by_name("golay")


def least_distance(codes: tuple[int, ...]) -> int:
    digits = digits_of_codes(np.array(codes))
    apart = (digits[:, None] != digits[None]).sum(axis=2)
    return int(apart[~np.eye(len(codes), dtype=bool)].min())


def least_lit(codes: tuple[int, ...]) -> int:
    return int((digits_of_codes(np.array(codes)) != 0).sum(axis=1).min())


@pytest.mark.parametrize(("count", "distance"), [(2, 9), (5, 8), (40, 6), (242, 6), (243, 5)])
def test_golay_codes_differ_in_as_many_dots_as_so_many_can(count: int, distance: int) -> None:
    codes = choose_codes(GOLAY, count)
    assert len(set(codes)) == count and least_distance(codes) >= distance
    assert least_lit(codes) >= 6


def test_the_whole_family_comes_with_the_dark_codes_last() -> None:
    codes = choose_codes(GOLAY, 728)
    assert sorted(codes) == GOLAY.codes.tolist()
    bright = int((digits_of_codes(GOLAY.codes) != 0).sum(axis=1).__ge__(6).sum())
    assert least_lit(codes[:bright]) >= 6 and least_lit(codes[bright:]) == 5


@given(st.sampled_from(["golay", "hamming"]), st.integers(1, 60), st.sets(st.integers(1, 2000), max_size=4))
def test_codes_are_of_the_family_keep_away_from_the_taken_ones_and_stay_the_same(
    name: str, count: int, taken: set[int]
) -> None:
    family = family_by_name(name)
    codes = choose_codes(family, count, taken)
    assert codes == choose_codes(family, count, sorted(taken, reverse=True))
    assert all(family.contains(code) for code in codes) and not taken & set(codes)


def test_more_than_the_family_holds_is_refused_with_the_number_that_can_be_had() -> None:
    with pytest.raises(InvalidInput, match="1 to 727") as refusal:
        choose_codes(GOLAY, 728, taken=[int(GOLAY.codes[0])])
    assert refusal.value.fields["available"] == 727
