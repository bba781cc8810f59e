from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.similarity import Similarity
from app.trajectories.alignment import AlignmentOptions, align
from app.trajectories.association import AssociationOptions, associate
from app.trajectories.metrics.errors import errors_of
from app.trajectories.metrics.running import RunningErrors
from app.trajectories.metrics.running_aligned import AlignedRunningErrors
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import noisy, walk


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


def test_an_aligned_error_so_far_is_that_of_the_last_fit_and_of_what_came_since() -> None:
    true = walk(30.0, 5.0)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    moved_m = Similarity(1.0, turn, np.array([9.0, 8.0, 7.0])).apply(noisy(true, 0.05).positions_m)
    said = Trajectory(true.times_s, moved_m)
    options = AlignmentOptions("posyaw")
    running = AlignedRunningErrors(options)
    running.add(tuple(moved_m[0].tolist()), tuple(true.positions_m[0].tolist()))
    assert running.so_far is None and running.alignment is None  # one pair fixes no heading
    for estimate_m, reference_m in zip(moved_m[1:].tolist(), true.positions_m[1:].tolist(), strict=True):
        running.add(tuple(estimate_m), tuple(reference_m))
    pairs = associate(true, said, AssociationOptions("nearest", 0.0))
    aligned = replace(pairs, estimate=align(pairs, options).apply(said))
    assert running.so_far is not None and running.so_far.count == len(true)
    # The last fit leaves out the last hundredth of the pairs at most, which moves the frame by less than that.
    assert running.so_far.rmse_m == pytest.approx(float(np.sqrt((errors_of(aligned).spatial_m ** 2).mean())), rel=0.01)


def test_pairs_at_once_are_pairs_one_by_one() -> None:
    horizontal_m, spatial_m = np.abs(np.random.default_rng(2).normal(size=(2, 20)))
    one_by_one, (at_once, told) = RunningErrors(), RunningErrors.of(horizontal_m, spatial_m)
    for plan_m, space_m in zip(horizontal_m.tolist(), spatial_m.tolist(), strict=True):
        so_far = one_by_one.add(plan_m, space_m)
    assert (told.ce50_m, told.ce95_m, told.count) == (so_far.ce50_m, so_far.ce95_m, so_far.count)
    assert at_once.add(0.1, 0.2).mean_m == pytest.approx(one_by_one.add(0.1, 0.2).mean_m)
