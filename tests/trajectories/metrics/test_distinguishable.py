from __future__ import annotations

import numpy as np
import pytest

from app.trajectories.metrics.distinguishable import verdict_on
from app.trajectories.metrics.errors import Errors

COUNT = 4000
COVARIANCE_M2 = np.array([[4.0, 1.0, 0.0], [1.0, 2.0, 0.5], [0.0, 0.5, 9.0]]) * 1e-6


def errors(system_sigma_m: float, seed: int = 1) -> Errors:
    """The reference's own uncertainty and a system's errors beside it."""
    random = np.random.default_rng(seed)
    own_m = random.multivariate_normal(np.zeros(3), COVARIANCE_M2, COUNT)
    vectors_m = own_m + random.normal(0.0, 1.0, (COUNT, 3)) * system_sigma_m
    return Errors(np.arange(COUNT, dtype=float), vectors_m, None, np.tile(COVARIANCE_M2, (COUNT, 1, 1)))


def test_a_perfect_system_cannot_be_told_from_the_reference() -> None:
    verdict = verdict_on(errors(0.0))
    assert verdict is not None and not verdict.distinguishable
    assert verdict.indistinct_share == pytest.approx(0.95, abs=0.015)
    assert verdict.measured_rms_m == pytest.approx(verdict.expected_rms_m, rel=0.05)
    assert "cannot be told" in verdict.sentence


def test_what_is_left_is_the_systems_own() -> None:
    verdict = verdict_on(errors(0.05))
    assert verdict is not None and verdict.distinguishable and verdict.system_rms_m is not None
    assert verdict.system_rms_m == pytest.approx(0.05 * np.sqrt(3), rel=0.05)
    assert verdict.indistinct_share < 0.01
    assert "exceeds" in verdict.sentence


def test_one_shared_offset_of_the_reference_is_not_blamed_on_the_system() -> None:
    """A datum that is off by 1.5 sigma shifts every pose alike: a thousand of them prove nothing."""
    shared_m = 1.5 * np.sqrt(np.diag(COVARIANCE_M2)) * [1.0, 0.5, 0.3]
    verdict = verdict_on(
        Errors(np.arange(1000.0), np.tile(shared_m, (1000, 1)), None, np.tile(COVARIANCE_M2, (1000, 1, 1)))
    )
    assert verdict is not None and not verdict.distinguishable


def test_a_direction_known_exactly_makes_any_error_along_it_distinct() -> None:
    flat = np.diag([1e-6, 1e-6, 0.0])[None]
    above = verdict_on(Errors(np.zeros(1), np.array([[0.0, 0.0, 1e-3]]), None, flat))
    within = verdict_on(Errors(np.zeros(1), np.array([[1e-3, 0.0, 0.0]]), None, flat))
    assert above is not None and above.distinguishable
    assert within is not None and not within.distinguishable


def test_without_covariances_there_is_no_verdict() -> None:
    assert verdict_on(Errors(np.zeros(1), np.zeros((1, 3)), None, None)) is None
