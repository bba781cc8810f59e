import numpy as np
import pytest

from app.targets.layout import DOT_COUNT
from app.vision.kernels.coefficients import CHANNELS, COEFFICIENTS
from app.vision.kernels.projection import solve_plates
from app.vision.template import BLUR_LEVELS, PatchGrid, plate_design, plate_template

PLATES = 3
UNTOUCHED = 77.0


@pytest.mark.parametrize("level", [BLUR_LEVELS[0], 11, BLUR_LEVELS[1]])
@pytest.mark.parametrize("grid", list(PatchGrid))
def test_plates_are_solved_as_by_the_whole_design(grid: PatchGrid, level: int) -> None:
    template, design = plate_template(grid, level), plate_design(grid, level)
    samples = np.random.default_rng(level).uniform(0.0, 255.0, (PLATES, CHANNELS, grid.value**2)).astype(np.float32)
    right, solved = np.full((2, PLATES, CHANNELS, COEFFICIENTS), UNTOUCHED)
    cofactors = np.full((PLATES, DOT_COUNT, 2, 2), UNTOUCHED)
    solve_plates(samples, np.array([0, 2]), template.parts, (right, solved, cofactors))
    for plate in (0, 2):
        expected = samples[plate].astype(np.float64) @ design
        # Sums of numbers of 32 bits: each lane of a register rounds some hundred times.
        np.testing.assert_allclose(right[plate], expected, atol=1e-5 * np.abs(expected).max())
        np.testing.assert_allclose(solved[plate], right[plate] @ template.cofactors, rtol=1e-9, atol=1e-7)
        np.testing.assert_array_equal(cofactors[plate], template.offset_cofactors)
    assert (right[1] == UNTOUCHED).all() and (solved[1] == UNTOUCHED).all() and (cofactors[1] == UNTOUCHED).all()
