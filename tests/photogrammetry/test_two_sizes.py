"""Two sizes of plates are told from one that scatters."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.photogrammetry.two_sizes import TwoSizesOptions, two_sizes

SIGMA = 0.001


def drawn(sizes: list[int], centres: list[float], scatter: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    values = np.repeat(centres, sizes)[:, None] + rng.normal(0, np.hypot(SIGMA, scatter), (sum(sizes), 2))
    return values, np.tile(SIGMA**2 * np.eye(2), (sum(sizes), 1, 1))


@given(seed=st.integers(0, 10_000), scatter=st.floats(0.0, 0.003))
@settings(max_examples=20, deadline=None)
def test_one_size_that_scatters_is_one(seed: int, scatter: float) -> None:
    assert two_sizes(*drawn([80], [1.0], scatter, seed), TwoSizesOptions()) is None


@pytest.mark.parametrize("share", [0.15, 0.5])
def test_two_sizes_are_found_where_no_plate_is_certain(share: float) -> None:
    small = int(200 * share)
    found = two_sizes(*drawn([200 - small, small], [1.0, 0.995], 0.0, 3), TwoSizesOptions())
    assert found is not None
    # Each centre is the mean of its plates: three standard errors, and the few on the wrong side.
    tolerance = 3.0 * SIGMA / np.sqrt(small) + 1e-4
    for centre in (1.0, 0.995):
        assert np.abs(found.centres - centre).max(axis=-1).min() < tolerance
    # 2.5 sigmas lie between a centre and the border along each of two axes: 2e-4 of the plates are beyond.
    wrong = (found.second != (np.arange(200) >= 200 - small)).mean()
    assert min(wrong, 1.0 - wrong) <= 0.01
