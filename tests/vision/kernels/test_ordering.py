import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.vision.kernels.ordering import middle_of, sort_few

FINITE = st.floats(-1e9, 1e9)


@given(arrays(np.float64, st.integers(0, 30), elements=FINITE))
def test_few_values_are_sorted(values: np.ndarray) -> None:
    ordered = values.copy()
    sort_few(ordered)
    np.testing.assert_array_equal(ordered, np.sort(values))


@given(arrays(np.float64, st.integers(0, 14).map(lambda half: 2 * half + 1), elements=FINITE))
def test_the_middle_of_an_odd_number_is_the_median(values: np.ndarray) -> None:
    assert middle_of(values.copy()) == pytest.approx(np.median(values))
