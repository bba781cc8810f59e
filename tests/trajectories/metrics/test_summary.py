from __future__ import annotations

import statistics

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.trajectories.metrics.summary import summarise

values = st.lists(st.floats(0.0, 1e3), min_size=2, max_size=30)


@given(values)
def test_a_summary_is_what_statistics_books_say(given_values: list[float]) -> None:
    summary = summarise(np.array(given_values))
    assert summary.mean == pytest.approx(statistics.fmean(given_values))
    assert summary.std == pytest.approx(statistics.pstdev(given_values), abs=1e-6)
    assert summary.median == pytest.approx(statistics.median(given_values))
    # Python's "inclusive" quantiles are those of type 7.
    assert summary.quantile_75 == pytest.approx(statistics.quantiles(given_values, n=4, method="inclusive")[2])
    assert summary.quantile_95 == pytest.approx(statistics.quantiles(given_values, n=20, method="inclusive")[18])
    assert summary.rms**2 == pytest.approx(summary.mean**2 + summary.std**2, abs=1e-6)
    assert summary.least <= summary.median <= summary.greatest <= summary.rms * np.sqrt(len(given_values)) + 1e-9


def test_one_value_is_its_own_summary_and_none_is_no_summary() -> None:
    one = summarise(np.array([3.0]))
    assert (one.mean, one.rms, one.std, one.quantile_95) == (3.0, 3.0, 0.0, 3.0)
    with pytest.raises(ValueError, match="one value"):
        summarise(np.zeros(0))
