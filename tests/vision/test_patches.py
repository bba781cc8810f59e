import numpy as np
import pytest

from app.planning.tone import linear_of_srgb
from app.vision.homography import apply_homographies
from app.vision.patches import LINEAR_FROM_CODED, PIXEL_VARIANCE, Pyramid, light_curve, take_patches
from app.vision.template import BLUR_STEP_U, PatchGrid

SIDE_PX = 128
GREY_PER_PX = 2  # even, so that the mean of two pixels is no half grey value


def ramps() -> np.ndarray:
    """Grey values that tell the place: blue is the column, green the row, red their mean."""
    row, column = GREY_PER_PX * np.mgrid[0:SIDE_PX, 0:SIDE_PX]
    return np.stack([column, row, (column + row) // 2], axis=-1).astype(np.uint8)


def plate_at_centre(px_per_u: float, perspective: float = 0.0, x_px: float = 63.3, y_px: float = 64.9) -> np.ndarray:
    turn = px_per_u * np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    image_from_plate = np.eye(3)
    image_from_plate[:2, :2], image_from_plate[:2, 2] = turn, (x_px, y_px)
    image_from_plate[2, 0] = perspective
    return image_from_plate[None]


def grey_of_linear(linear: np.ndarray) -> np.ndarray:
    return np.interp(linear, LINEAR_FROM_CODED, np.arange(256))


def test_grey_values_become_linear_light() -> None:
    np.testing.assert_allclose(LINEAR_FROM_CODED, 255 * linear_of_srgb(np.arange(256)), rtol=1e-6, atol=1e-4)


def test_the_polynomial_is_the_curve() -> None:
    *factors, begins, straight = light_curve()
    grey = np.arange(256)
    bent = np.polynomial.Polynomial(factors)(grey)
    np.testing.assert_allclose(np.where(grey < begins, straight * grey, bent), LINEAR_FROM_CODED, atol=0.01)


@pytest.mark.parametrize("shape", [(1, 1, 3), (1, 9, 3), (9, 1, 3)])
def test_a_single_row_or_column_can_be_sampled(shape: tuple[int, ...]) -> None:
    picture = np.full(shape, 100, dtype=np.uint8)
    patches = take_patches(Pyramid.of(picture, 1), plate_at_centre(3.0), PatchGrid.ROUGH)
    np.testing.assert_allclose(patches.samples, LINEAR_FROM_CODED[100], atol=0.01)


@pytest.mark.parametrize(
    ("size_px", "count", "halvings_max"), [((640, 480), 3, 2), ((7, 5), 4, 2), ((1, 1), 3, 0), ((9, 1), 2, 0)]
)
def test_a_photograph_is_halved_as_long_as_a_pixel_is_left(
    size_px: tuple[int, int], count: int, halvings_max: int
) -> None:
    pyramid = Pyramid.of(np.zeros((size_px[1], size_px[0], 3), dtype=np.uint8), count)
    assert pyramid.size_px == size_px
    assert pyramid.halvings_max == halvings_max


@pytest.mark.parametrize("grid", list(PatchGrid))
@pytest.mark.parametrize(("px_per_u", "perspective"), [(3.0, 0.0), (4.5, 0.01), (7.0, -0.01), (13.0, 0.005)])
def test_samples_are_taken_where_the_homography_says(grid: PatchGrid, px_per_u: float, perspective: float) -> None:
    """At any size: halved pictures have their pixel centres elsewhere."""
    homography = plate_at_centre(px_per_u, perspective)
    patches = take_patches(Pyramid.of(ramps(), 4), homography, grid)
    assert patches.samples.shape == (1, 3, grid.value**2)
    where_px = apply_homographies(homography, grid.points_u())[0]
    inside = ((where_px > 8) & (where_px < SIDE_PX - 9)).all(axis=1)
    seen_px = grey_of_linear(patches.samples[0, :2]).T / GREY_PER_PX
    # Grey values are rounded, and OpenCV interpolates in steps of 1/32 of the level's px.
    pixel_px = np.sqrt(patches.pixel_px2[0] / PIXEL_VARIANCE + 1.0)
    np.testing.assert_allclose(seen_px[inside], where_px[inside], atol=0.5 / GREY_PER_PX + pixel_px / 32.0)
    shift_px = (seen_px[inside] - where_px[inside]).mean(axis=0)
    assert np.abs(shift_px).max() < 0.05 + pixel_px / 64.0  # remap rounds places to its steps, half up


def test_large_plates_are_sampled_from_a_halved_picture() -> None:
    pyramid = Pyramid.of(ramps(), 3)
    limit = PatchGrid.DENSE.px_per_u_max
    for px_per_u, halvings in ((0.9 * limit, 0), (1.5 * limit, 1), (3.0 * limit, 2), (20.0 * limit, 2)):
        patches = take_patches(pyramid, plate_at_centre(px_per_u), PatchGrid.DENSE)
        np.testing.assert_allclose(patches.px_per_u, [px_per_u])
        np.testing.assert_allclose(patches.pixel_px2, [(4.0**halvings - 1.0) * PIXEL_VARIANCE])


def test_a_pixel_blurs_by_its_box_and_by_bilinear_sampling() -> None:
    fine = np.linspace(-1.0, 1.0, 200_001)
    box, triangle = np.abs(fine) <= 0.5, 1.0 - np.abs(fine)
    variances = [(fine**2 * shape).sum() / shape.sum() for shape in (box, triangle)]
    assert pytest.approx(sum(variances), rel=1e-4) == PIXEL_VARIANCE


def test_the_template_follows_blur_and_size() -> None:
    patches = take_patches(
        Pyramid.of(ramps(), 3), np.concatenate([plate_at_centre(4.0), plate_at_centre(8.0)]), PatchGrid.FINE
    )
    blur_px = np.array([1.2, 1.2])
    # The second is sampled from a halved picture: its pixels are twice as large.
    expected_u = np.sqrt(blur_px**2 + [0.0, 3.0 * PIXEL_VARIANCE]) / [4.0, 8.0]
    expected = np.rint(expected_u / BLUR_STEP_U).astype(int)
    assert patches.levels(blur_px).tolist() == expected.tolist()
    chosen = np.array([1, 0, 1])
    assert patches.levels(np.full(3, 1.2), chosen).tolist() == expected[chosen].tolist()


def test_beyond_the_frame_its_border_goes_on() -> None:
    patches = take_patches(Pyramid.of(ramps(), 1), plate_at_centre(4.0, x_px=-100.0), PatchGrid.FINE)
    np.testing.assert_array_equal(patches.samples[0, 0], 0.0)  # the first column's blue
