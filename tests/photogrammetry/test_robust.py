"""Robust losses: square when small, their weight is their derivative."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.photogrammetry.robust import RobustLoss, robust_scale

LOSSES = [RobustLoss("huber", 3.0), RobustLoss("cauchy", 3.0)]


@pytest.mark.parametrize("loss", LOSSES)
@given(length=st.floats(0.0, 100.0))
def test_the_weight_is_the_derivative_of_the_cost_by_the_square(loss: RobustLoss, length: float) -> None:
    squared, step = np.array(length**2 + 0.01), 1e-4
    slope = (loss.cost(squared + step) - loss.cost(squared - step)) / (2.0 * step)
    # Within a step of Huber's corner the slope is a mean of both sides.
    np.testing.assert_allclose(slope, loss.weight(squared), rtol=1e-4)


@pytest.mark.parametrize("loss", LOSSES)
def test_small_residuals_cost_their_square(loss: RobustLoss) -> None:
    squared = np.array([1e-8, 1e-6])
    np.testing.assert_allclose(loss.cost(squared), squared, rtol=1e-6)
    np.testing.assert_allclose(loss.weight(squared), 1.0, rtol=1e-6)


def test_robust_scale_is_the_standard_deviation_of_normal_residuals() -> None:
    count = 20_000
    residuals = np.random.default_rng(5).normal(0.0, 2.5, (count, 2))
    # The median of n Rayleigh lengths has a relative deviation of 1 / (2 ln 2 sqrt(n)), half a percent; four of them.
    assert abs(robust_scale((residuals**2).sum(axis=-1)) / 2.5 - 1.0) < 4.0 / (2.0 * np.log(2.0) * np.sqrt(count))
