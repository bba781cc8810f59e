"""One step of a target's movement is that of its normal equations, and is determined where their eigenvalues say so."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.photogrammetry.kernels.layout import COLUMNS, OWN
from app.photogrammetry.kernels.movements import step_movements


@given(seed=st.integers(0, 10_000), weakest=st.sampled_from([1e-9, 1e-7, 1e-3, 1.0]))
@settings(max_examples=40, deadline=None)
def test_steps_solve_the_normal_equations_that_determine_them(seed: int, weakest: float) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(32, COLUMNS)) * np.logspace(0.0, 4.0, COLUMNS)
    rows[:, 1] = rows[:, 0] + weakest * rows[:, 1] * rows[0, 0] / rows[0, 1]
    gram = rows.T @ rows
    determined, steps = np.empty(1, dtype=np.bool_), np.empty((1, OWN))
    step_movements(gram[None], 1e-5, determined, steps)
    scale = np.sqrt(np.diag(gram)[:OWN])
    least = np.linalg.eigvalsh(gram[:OWN, :OWN] / np.outer(scale, scale))[0]
    assert determined[0] == (least > 1e-5)
    if determined[0]:
        # Rounding of 1e-16 grows by the condition, 1e5 at most.
        expected = -np.linalg.solve(gram[:OWN, :OWN] / np.outer(scale, scale), gram[:OWN, -1] / scale) / scale
        np.testing.assert_allclose(steps[0], expected, rtol=1e-8, atol=1e-9 * np.abs(expected).max())


def test_a_target_without_dots_determines_nothing() -> None:
    determined, steps = np.ones(1, dtype=np.bool_), np.empty((1, OWN))
    step_movements(np.zeros((1, COLUMNS, COLUMNS)), 1e-5, determined, steps)
    assert not determined[0]
