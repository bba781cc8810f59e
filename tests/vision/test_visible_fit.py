import numpy as np
import pytest

from app.targets.layout import DOT_COUNT
from app.vision.kernels.coefficients import BACKGROUND, CHANNELS, COEFFICIENTS, PAPER, PER_DOT
from app.vision.patches import Patches
from app.vision.template import BLUR_LEVELS, BLUR_STEP_U, PAPER_RIDGE, PATCH_REACH_U, PatchGrid, plate_design
from app.vision.visible_fit import HIDDEN_RIDGE, READ_SHARE, fit_visible

PX_PER_U = 5.0


def random_patches(grid: PatchGrid, plates: int, seed: int) -> Patches:
    samples = np.random.default_rng(seed).uniform(0.0, 255.0, (plates, CHANNELS, grid.value**2)).astype(np.float32)
    homographies = np.tile(np.diag([PX_PER_U, PX_PER_U, 1.0]), (plates, 1, 1))
    return Patches(samples, homographies, np.full(plates, PX_PER_U), np.zeros(plates), grid)


def without_a_side(grid: PatchGrid, plates: int, seed: int) -> np.ndarray:
    """Samples beyond a line at random, aslant: from a tenth to a half of the plate is hidden."""
    rng = np.random.default_rng(seed)
    angle_rad, off_u = rng.uniform(0.0, 2.0 * np.pi, plates), rng.uniform(0.0, 0.8 * PATCH_REACH_U, plates)
    return np.stack([np.cos(angle_rad), np.sin(angle_rad)], axis=1) @ grid.points_u().T < off_u[:, None]


@pytest.mark.parametrize("level", [BLUR_LEVELS[0], 9, BLUR_LEVELS[1]])
@pytest.mark.parametrize("grid", [PatchGrid.ROUGH, PatchGrid.FINE])
def test_fits_are_those_of_the_design_without_its_hidden_rows(grid: PatchGrid, level: int) -> None:
    plates = 3
    patches, seen = random_patches(grid, plates, level), without_a_side(grid, plates, level)
    visible = fit_visible(patches, level * BLUR_STEP_U * PX_PER_U, seen)
    design = plate_design(grid, level)
    for plate in range(plates):
        rows, samples = design[seen[plate]], patches.samples[plate][:, seen[plate]].T.astype(np.float64)
        ridge = np.where(np.arange(COEFFICIENTS) < PAPER, HIDDEN_RIDGE, PAPER_RIDGE * len(rows))
        cofactors = np.linalg.inv(rows.T @ rows + np.diag(ridge))
        solved = cofactors @ rows.T @ samples
        shares = rows[:, :BACKGROUND:PER_DOT].sum(axis=0) / design[:, :BACKGROUND:PER_DOT].sum(axis=0)
        np.testing.assert_allclose(visible.shares[plate], shares, atol=1e-5)
        read = np.flatnonzero(shares > READ_SHARE)
        dots = solved[:BACKGROUND].reshape(DOT_COUNT, PER_DOT, CHANNELS)
        # Sums of numbers of 32 bits, divided by as little as a third of a dot.
        np.testing.assert_allclose(visible.fits.amplitudes[plate, read], dots[read, 0], atol=0.05)
        np.testing.assert_allclose(visible.fits.slopes[plate, read], dots[read, 1:], atol=0.05)
        first = PER_DOT * read + 1
        for axis in range(2):
            variances = cofactors[first + axis, first + axis]
            np.testing.assert_allclose(visible.fits.offset_cofactors[plate, read, axis, axis], variances, rtol=1e-3)
        left = samples - rows @ solved
        np.testing.assert_allclose(visible.fits.residual_rms[plate], np.sqrt((left**2).mean()), rtol=1e-4)
        spread = samples - samples.mean(axis=0)
        np.testing.assert_allclose(visible.fits.spread_rms[plate], np.sqrt((spread**2).mean()), rtol=1e-4)
    assert (visible.fits.amplitudes[visible.hidden] == 0.0).all() and visible.hidden.any()
