"""Accuracy in the terms of ISO/IEC 18305, and the tables of the paper from its coordinates."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from app.trajectories.association import AssociationOptions, associate
from app.trajectories.metrics.accuracy import accuracy_of
from app.trajectories.metrics.bands import counts_in_bands
from app.trajectories.metrics.errors import Errors, errors_of
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import walk

PAPER = Path(__file__).parents[1] / "paper"
PHONES = "samsung-galaxy-s8", "huawei-p10"

# Table 4, RMSE (m) of dx, dy and the distance; where print and coordinates differ in the fourth decimal, the latter.
TABLE_4 = {
    ("samsung-galaxy-s8", 1): (0.0650, 0.0543, 0.0847),
    ("samsung-galaxy-s8", 2): (0.0591, 0.0597, 0.0840),
    ("huawei-p10", 1): (0.0629, 0.0669, 0.0918),
    ("huawei-p10", 2): (0.0757, 0.0488, 0.0901),
}
# Table 3, points with a difference above 10 cm, from 1 to 10 cm, and below 1 cm: in x, in y.
TABLE_3 = {
    ("samsung-galaxy-s8", 1): ((1, 18, 1), (0, 17, 3)),
    ("samsung-galaxy-s8", 2): ((1, 17, 2), (2, 14, 4)),
    ("huawei-p10", 1): ((0, 19, 1), (1, 18, 1)),
    ("huawei-p10", 2): ((2, 18, 0), (1, 17, 2)),
}


def paper_errors(phone: str, measurement: int) -> Errors:
    """A phone's measurement against the truth; points stand for moments."""
    with (PAPER / f"{phone}.csv").open() as file:
        rows = list(csv.DictReader(file))

    def positions(name: str) -> Trajectory:
        plan_m = np.array([[float(row[f"{name}_x_m"]), float(row[f"{name}_y_m"])] for row in rows])
        return Trajectory(np.arange(len(rows), dtype=float), np.column_stack([plan_m, np.zeros(len(rows))]))

    exact = AssociationOptions("nearest", max_gap_s=0.0)
    return errors_of(associate(positions("truth"), positions(f"measure{measurement}"), exact))


@pytest.mark.parametrize(("phone", "measurement"), TABLE_4)
def test_table_4_follows_from_the_coordinates(phone: str, measurement: int) -> None:
    accuracy = accuracy_of(paper_errors(phone, measurement))
    found = (*accuracy.rms_m[:2].tolist(), accuracy.horizontal.rms)
    assert tuple(round(value, 4) for value in found) == TABLE_4[phone, measurement]
    assert accuracy.horizontal.count == 20


@pytest.mark.parametrize(("phone", "measurement"), TABLE_3)
def test_table_3_counts_the_differences(phone: str, measurement: int) -> None:
    counts = counts_in_bands(paper_errors(phone, measurement), [0.01, 0.10])
    for axis, (above, between, below) in enumerate(TABLE_3[phone, measurement]):
        assert counts[axis].tolist() == [below, between, above]


def test_limits_of_bands_increase() -> None:
    errors = Errors(np.zeros(2), np.array([[0.3 - 0.2, 0.0, 0.05], [0.11, 0.01, 0.0]]), None, None)
    assert counts_in_bands(errors, [0.01, 0.1]).tolist() == [[0, 1, 1], [1, 1, 0], [1, 1, 0]]
    assert counts_in_bands(errors, [0.01]).tolist() == [[0, 2], [1, 1], [1, 1]]
    for wrong in ([], [0.1, 0.01]):
        with pytest.raises(ValueError, match="limits increase"):
            counts_in_bands(errors, wrong)


def test_circular_errors_are_quantiles_of_what_was_put_in() -> None:
    """Of normal errors with sigma s in the plan CE50 is 1.1774 s and CE95 2.4477 s (Rayleigh), VE95 1.9600 s."""
    count, sigma_m = 40_000, 0.05
    vectors_m = np.random.default_rng(6).normal(0.0, sigma_m, (count, 3))
    accuracy = accuracy_of(Errors(np.arange(count, dtype=float), vectors_m, None, None))
    # Quantiles of n draws scatter by sqrt(p (1 - p) / n) over the density: below 1 % here.
    assert accuracy.horizontal.median == pytest.approx(1.1774 * sigma_m, rel=0.03)
    assert accuracy.horizontal.quantile_95 == pytest.approx(2.4477 * sigma_m, rel=0.03)
    assert accuracy.vertical.quantile_95 == pytest.approx(1.96 * sigma_m, rel=0.03)
    np.testing.assert_allclose(accuracy.covariance_m2, sigma_m**2 * np.eye(3), atol=0.05 * sigma_m**2)
    np.testing.assert_allclose(accuracy.bias_m, 0.0, atol=5 * sigma_m / np.sqrt(count))


def test_rotation_errors_need_orientations_on_both_sides() -> None:
    true = walk(5.0)
    exact = AssociationOptions("nearest", max_gap_s=0.0)
    both = accuracy_of(errors_of(associate(true, true, exact))).rotation
    assert both is not None and both.greatest < 1e-7
    positions = Trajectory(true.times_s, true.positions_m)
    assert accuracy_of(errors_of(associate(true, positions, exact))).rotation is None


def test_one_pair_has_no_covariance_of_its_own() -> None:
    accuracy = accuracy_of(Errors(np.zeros(1), np.array([[3.0, 4.0, 12.0]]), None, None))
    assert (accuracy.horizontal.mean, accuracy.vertical.mean, accuracy.spatial.mean) == (5.0, 12.0, 13.0)
    np.testing.assert_array_equal(accuracy.covariance_m2, np.zeros((3, 3)))
