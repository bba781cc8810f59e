import cv2
import numpy as np
import pytest

from app.targets.layout import DOT_COUNT, DOT_RADIUS_U, PLATE_SIDE_U
from app.vision.homography import PLATE_DOTS_U
from app.vision.kernels.coefficients import BACKGROUND, COEFFICIENTS, PAPER, PER_DOT
from app.vision.template import (
    BLUR_LEVELS,
    BLUR_STEP_U,
    PATCH_REACH_U,
    PatchGrid,
    blur_level,
    blurred_disc,
    plate_design,
    plate_template,
)

DIFFERENCE_STEP = 0.1  # of the blur: a central difference then errs by a third of a per cent of the greatest slope
DIFFERENCE_ERROR = 0.01
LEVELS = [BLUR_LEVELS[0], 7, 15, BLUR_LEVELS[1]]
FINE_STEP_U = 1 / 40  # of the pictures that are convolved numerically


def disc_columns(samples_u: np.ndarray, centres_u: np.ndarray, blur_u: float) -> np.ndarray:
    """Blurred discs of the centres at the samples, shape (S, centres)."""
    return blurred_disc(np.linalg.norm(samples_u[:, None] - centres_u, axis=2), blur_u)[0]


def gauss(blur_u: float) -> np.ndarray:
    return cv2.getGaussianKernel(2 * round(6 * blur_u / FINE_STEP_U) + 1, blur_u / FINE_STEP_U)


def fine_axis(reach_u: float) -> np.ndarray:
    count = round(reach_u / FINE_STEP_U)
    return np.arange(-count, count + 1) * FINE_STEP_U


@pytest.mark.parametrize("level", LEVELS)
def test_the_blurred_disc_is_the_numerical_convolution(level: int) -> None:
    blur_u = level * BLUR_STEP_U
    axis = fine_axis(DOT_RADIUS_U + 6 * blur_u)
    # The rim is softened over one step: its area then errs by the square of the step.
    disc = np.clip((DOT_RADIUS_U - np.hypot(axis, axis[:, None])) / FINE_STEP_U + 0.5, 0.0, 1.0)
    expected = cv2.sepFilter2D(disc, -1, gauss(blur_u), gauss(blur_u))[len(axis) // 2]
    np.testing.assert_allclose(blurred_disc(np.abs(axis), blur_u)[0], expected, atol=2e-3)


@pytest.mark.parametrize("level", range(BLUR_LEVELS[0], BLUR_LEVELS[1] + 1, 3))
def test_blur_takes_no_light_away(level: int) -> None:
    radius_u = np.linspace(0.0, 8.0, 8001)
    disc, _ = blurred_disc(radius_u, level * BLUR_STEP_U)
    light = np.trapezoid(2.0 * np.pi * radius_u * disc, radius_u)
    assert light == pytest.approx(np.pi * DOT_RADIUS_U**2, rel=1e-3)  # the table is interpolated linearly


@pytest.mark.parametrize("level", LEVELS)
def test_the_discs_derivative_is_the_difference(level: int) -> None:
    blur_u = level * BLUR_STEP_U
    step_u = DIFFERENCE_STEP * blur_u
    radius_u = np.linspace(step_u, 2.5, 400)
    forth, back = blurred_disc(np.stack([radius_u + step_u, radius_u - step_u]), blur_u)[0]
    slope = blurred_disc(radius_u, blur_u)[1]
    np.testing.assert_allclose(slope, (forth - back) / (2 * step_u), atol=DIFFERENCE_ERROR * np.abs(slope).max())


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("grid", list(PatchGrid))
def test_design_columns_are_the_dots_and_their_differences(grid: PatchGrid, level: int) -> None:
    samples_u, blur_u, dots = grid.points_u(), level * BLUR_STEP_U, [0, 6, 13]
    step_u = DIFFERENCE_STEP * blur_u
    steps_u = step_u * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    design = plate_design(grid, level)
    assert design.shape == (grid.value**2, COEFFICIENTS)
    columns = design[:, :BACKGROUND].reshape(len(samples_u), DOT_COUNT, PER_DOT)[:, dots]
    moved = disc_columns(samples_u, (PLATE_DOTS_U[dots, None] + steps_u).reshape(-1, 2), blur_u)
    disc, right, left, down, up = np.moveaxis(moved.reshape(len(samples_u), len(dots), 5), 2, 0)
    np.testing.assert_allclose(columns[..., 0], disc, atol=1e-4)  # what is left of a dot outside its window
    allowed = DIFFERENCE_ERROR * np.abs(columns[..., 1:]).max()
    np.testing.assert_allclose(columns[..., 1], (right - left) / (2 * step_u), atol=allowed)
    np.testing.assert_allclose(columns[..., 2], (down - up) / (2 * step_u), atol=allowed)


@pytest.mark.parametrize("level", [5, 20])
def test_the_paper_shows_where_the_blurred_plate_ends(level: int) -> None:
    blur_u = level * BLUR_STEP_U
    axis = fine_axis(PLATE_SIDE_U / 2 + 6 * blur_u)
    line = np.clip((PLATE_SIDE_U / 2 - np.abs(axis)) / FINE_STEP_U + 0.5, 0.0, 1.0)
    inside = np.interp(PatchGrid.FINE.points_u(), axis, np.convolve(line, gauss(blur_u)[:, 0], mode="same"))
    paper = 1.0 - inside.prod(axis=1)
    design = plate_design(PatchGrid.FINE, level)
    np.testing.assert_allclose(design[:, PAPER], paper, atol=2e-3)
    across = design[:, PAPER, None] * PatchGrid.FINE.points_u() / PATCH_REACH_U
    np.testing.assert_allclose(design[:, PAPER + 1 :], across, atol=1e-6)


def test_the_background_is_a_plane() -> None:
    design = plate_design(PatchGrid.ROUGH, 10)[:, BACKGROUND:PAPER]
    points = PatchGrid.ROUGH.points_u() / PATCH_REACH_U
    np.testing.assert_allclose(design, np.column_stack([np.ones(len(points)), points]), atol=1e-6)


@pytest.mark.parametrize("grid", list(PatchGrid))
def test_coefficients_are_recovered_from_the_models_own_samples(grid: PatchGrid) -> None:
    template, design = plate_template(grid, 12), plate_design(grid, 12)
    coefficients = np.random.default_rng(1).normal(size=COEFFICIENTS)
    coefficients[PAPER:] = 0.0  # the paper's ridge holds these back
    solved = template.cofactors @ (design.T @ (design @ coefficients))
    np.testing.assert_allclose(solved, coefficients, atol=2e-3)  # float32 design


@pytest.mark.parametrize(("grid", "level"), [(PatchGrid.FINE, 6), (PatchGrid.FINE, 15), (PatchGrid.DENSE, 6)])
def test_a_dot_is_found_where_it_was_put(grid: PatchGrid, level: int) -> None:
    """Dots drawn off their grid places: the ratio of derivative to disc is the offset, to second order."""
    rng = np.random.default_rng(2)
    template, samples_u, blur_u = plate_template(grid, level), grid.points_u(), level * BLUR_STEP_U
    offset_u, amplitude = rng.uniform(-0.1, 0.1, (DOT_COUNT, 2)), rng.uniform(0.5, 2.0, DOT_COUNT)
    samples = 0.1 + disc_columns(samples_u, PLATE_DOTS_U + offset_u, blur_u) @ amplitude
    solved = template.cofactors @ (plate_design(grid, level).T @ samples)
    dots = solved[:BACKGROUND].reshape(DOT_COUNT, PER_DOT)
    second_order_u = 0.1**2  # offsets squared, over the blur or the radius
    np.testing.assert_allclose(dots[:, 1:] / dots[:, :1], offset_u, atol=second_order_u)
    assert solved[BACKGROUND] == pytest.approx(0.1, abs=0.05)
    np.testing.assert_allclose(dots[:, 0], amplitude, rtol=0.1)


def test_cofactors_are_the_scatter_under_noise() -> None:
    template, trials = plate_template(PatchGrid.FINE, 10), 1500
    noise = np.random.default_rng(3).normal(size=(PatchGrid.FINE.value**2, trials))
    solved = template.cofactors @ (plate_design(PatchGrid.FINE, 10).T @ noise)
    for dot in (0, 5, 10):
        first = PER_DOT * dot + 1
        scatter = np.cov(solved[first : first + 2])
        # Variances of so many trials scatter by sqrt(2 / trials) = 4 %; four times that.
        expected = template.offset_cofactors[dot]
        np.testing.assert_allclose(scatter, expected, atol=4 * np.sqrt(2 / trials) * expected.max())


def test_levels_round_to_the_nearest_blur_and_stay_in_range() -> None:
    blurs_u = np.array([0.0, 0.089, 0.3, 0.314, 0.316, 50.0])
    assert blur_level(blurs_u).tolist() == [BLUR_LEVELS[0], 3, 10, 10, 11, BLUR_LEVELS[1]]


@pytest.mark.parametrize("grid", list(PatchGrid))
def test_samples_cover_the_plate_and_nothing_else(grid: PatchGrid) -> None:
    points_u = grid.points_u()
    assert np.abs(points_u).max() == PATCH_REACH_U < PLATE_SIDE_U / 2
    np.testing.assert_allclose(points_u.mean(axis=0), 0.0, atol=1e-12)
    np.testing.assert_array_equal(points_u[: grid.value, 0], grid.axis_u())
