import numpy as np
import pytest

from app.planning.surfaces import PAPER_ALBEDO, PictureSurface, PlainSurface, PlateSurface, Samples, box_coverage
from app.planning.tone import linear_of_srgb
from app.targets.drawing import BLACK_RGB, PAPER_RGB, cell_colours_rgb
from app.targets.layout import dot_centres_u

U_M = 0.014


def grid(side_m: float, count: int) -> Samples:
    step_m = side_m / count
    along = (np.arange(count) + 0.5) * step_m - side_m / 2
    x_m, y_m = np.meshgrid(along, -along)
    return Samples(x_m, y_m, np.broadcast_to(np.diag([step_m, -step_m]), (count, count, 2, 2)))


def at_points(points_m: np.ndarray) -> Samples:
    by_step_m = np.broadcast_to(np.eye(2) * 1e-4, (1, len(points_m), 2, 2))
    return Samples(points_m[None, :, 0], points_m[None, :, 1], by_step_m)


def test_a_plate_shows_its_colours_at_the_dots_black_between_and_paper_around() -> None:
    surface = PlateSurface.of_code(389, U_M)
    dots = surface.albedo(at_points(dot_centres_u() * U_M))[0]
    np.testing.assert_allclose(dots, PAPER_ALBEDO * linear_of_srgb(cell_colours_rgb(389)))
    between = surface.albedo(at_points((dot_centres_u() + 1.5) * U_M))[0]
    np.testing.assert_allclose(between, np.broadcast_to(PAPER_ALBEDO * linear_of_srgb(BLACK_RGB), (16, 3)))
    paper = surface.albedo(at_points(np.array([[7.0, 0.0], [0.0, -7.0]]) * U_M))[0]
    np.testing.assert_allclose(paper, np.broadcast_to(PAPER_ALBEDO * linear_of_srgb(PAPER_RGB), (2, 3)))


def test_the_print_scale_stretches_the_plate() -> None:
    surface = PlateSurface(cell_colours_rgb(389), U_M, (1.1, 0.9))
    dots = surface.albedo(at_points(dot_centres_u() * U_M * [1.1, 0.9]))[0]
    np.testing.assert_allclose(dots, PAPER_ALBEDO * linear_of_srgb(cell_colours_rgb(389)))


@pytest.mark.parametrize("samples_per_radius", [10, 20])
def test_dots_keep_their_area_however_finely_they_are_sampled(samples_per_radius: int) -> None:
    white = PlateSurface(np.full((16, 3), 255, dtype=np.uint8), U_M)
    samples = grid(12 * U_M, 12 * samples_per_radius)
    black, paper = (PAPER_ALBEDO * linear_of_srgb(rgb)[0] for rgb in (BLACK_RGB, PAPER_RGB))
    share = ((white.albedo(samples)[..., 0] - black) / (paper - black)).mean()
    # An edge softened over one sample of 1 / n of the radius changes the area by at most 1 / (4 n^2) of it.
    assert share == pytest.approx(16 * np.pi / 144, rel=0.25 / samples_per_radius**2)


def test_box_coverage_adds_up_to_the_box() -> None:
    samples = grid(2.0, 100)
    area = box_coverage(samples.x_m, samples.y_m, (1.013, 0.487), samples.by_step_m).sum() * 0.02**2
    assert area == pytest.approx(1.013 * 0.487, rel=1e-9)


def test_pictures_are_stretched_over_their_panel_upright() -> None:
    picture = np.zeros((2, 2, 3), dtype=np.float32)
    picture[0, 1] = [1.0, 0.5, 0.25]  # top right
    seen = PictureSurface(picture, 4.0, 2.0).albedo(at_points(np.array([[1.0, 0.5], [-1.0, 0.5], [1.0, -0.5]])))[0]
    np.testing.assert_allclose(seen, [[1.0, 0.5, 0.25], [0, 0, 0], [0, 0, 0]], atol=1e-6)


def test_plain_surfaces_are_plain() -> None:
    seen = PlainSurface((10, 200, 30)).albedo(grid(1.0, 3))
    np.testing.assert_allclose(seen, np.broadcast_to(linear_of_srgb((10, 200, 30)), (3, 3, 3)))


def test_a_plate_has_sixteen_colours() -> None:
    with pytest.raises(ValueError, match="sixteen"):
        PlateSurface(np.zeros((15, 3), dtype=np.uint8), U_M)
