import numpy as np
import pytest

from app.vision.kernels.coefficients import CHANNELS, COEFFICIENTS, solve_plate
from app.vision.kernels.projection import WINDOW_STEP, project_plate
from app.vision.template import BLUR_LEVELS, PatchGrid, plate_design, plate_template, shelf_with


@pytest.mark.parametrize("level", [BLUR_LEVELS[0], 11, BLUR_LEVELS[1]])
@pytest.mark.parametrize("grid", list(PatchGrid))
def test_plates_are_solved_as_by_the_whole_design(grid: PatchGrid, level: int) -> None:
    template, design = plate_template(grid, level), plate_design(grid, level)
    assert (template.windows[:, 2] % WINDOW_STEP == 0).all()
    samples = np.random.default_rng(level).uniform(0.0, 255.0, (CHANNELS, grid.value**2)).astype(np.float32)
    right, solved = np.empty((2, CHANNELS, COEFFICIENTS))
    room = np.full(
        (CHANNELS, template.weights.shape[2]), 255.0, dtype=np.float32
    )  # what is behind a window has no weight
    project_plate(samples, shelf_with(grid, np.array([level])).parts, level, room, right)
    solve_plate(right, template.cofactors, solved)
    expected = samples.astype(np.float64) @ design
    # Sums of numbers of 32 bits: each lane of a register rounds some hundred times.
    np.testing.assert_allclose(right, expected, atol=1e-5 * np.abs(expected).max())
    np.testing.assert_allclose(solved, right @ template.cofactors, rtol=1e-9, atol=1e-7)
