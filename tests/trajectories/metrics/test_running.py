from __future__ import annotations

import numpy as np
import pytest

from app.trajectories.metrics.running import RunningErrors


def test_the_error_so_far_is_that_of_all_pairs_so_far() -> None:
    horizontal_m, spatial_m = np.abs(np.random.default_rng(1).normal(size=(2, 50)))
    running = RunningErrors()
    for count, (plan_m, space_m) in enumerate(zip(horizontal_m.tolist(), spatial_m.tolist(), strict=True), start=1):
        so_far = running.add(plan_m, space_m)
        assert so_far.count == count
        assert so_far.mean_m == pytest.approx(spatial_m[:count].mean())
        assert so_far.rmse_m == pytest.approx(np.sqrt((spatial_m[:count] ** 2).mean()))
        expected = np.quantile(horizontal_m[:count], [0.5, 0.95])
        np.testing.assert_allclose([so_far.ce50_m, so_far.ce95_m], expected)
