import cv2
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.targets.layout import BASE_CELLS, DOT_PITCH_U, dot_centres_u
from app.vision.homography import (
    PLATE_DOTS_U,
    apply_homographies,
    area_scales,
    cross,
    fit_homographies,
    homography_jacobians,
    image_from_corner_dots,
    local_px_per_u,
)
from app.vision.kernels.homographies import CORNER_DOT_U
from tests.vision.views import image_from_plate, views

CORNERS = list(BASE_CELLS[:4])
TOLERANCE_PX = 1e-6  # of coordinates up to some thousand px in double precision
FIT_TOLERANCE_PX = 1e-3  # normal equations square the condition; a fiftieth of what a good dot is measured to


def apply_plainly(homography: np.ndarray, points: np.ndarray) -> np.ndarray:
    image = np.column_stack([points, np.ones(len(points))]) @ homography.T
    return image[:, :2] / image[:, 2:]


def test_plate_coordinates_are_the_layouts_with_y_down() -> None:
    np.testing.assert_array_equal(PLATE_DOTS_U, dot_centres_u() * [1, -1])
    assert CORNER_DOT_U == 1.5 * DOT_PITCH_U
    np.testing.assert_array_equal(PLATE_DOTS_U[CORNERS], CORNER_DOT_U * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]))


@given(homographies=st.lists(views, min_size=1, max_size=5))
def test_many_plates_are_projected_as_each_alone(homographies: list[np.ndarray]) -> None:
    image_px = apply_homographies(np.stack(homographies), PLATE_DOTS_U)
    for one, homography in zip(image_px, homographies, strict=True):
        np.testing.assert_allclose(one, apply_plainly(homography, PLATE_DOTS_U), atol=TOLERANCE_PX)
    own_points = np.stack([PLATE_DOTS_U + index for index in range(len(homographies))])
    image_px = apply_homographies(np.stack(homographies), own_points)
    for one, homography, points in zip(image_px, homographies, own_points, strict=True):
        np.testing.assert_allclose(one, apply_plainly(homography, points), atol=TOLERANCE_PX)


@given(homography=views)
def test_the_closed_form_is_the_plate_through_its_corner_dots(homography: np.ndarray) -> None:
    dots_px = apply_plainly(homography, PLATE_DOTS_U)
    closed = image_from_corner_dots(dots_px[None, CORNERS])
    np.testing.assert_allclose(apply_homographies(closed, PLATE_DOTS_U)[0], dots_px, atol=1e-5)
    opencv = cv2.getPerspectiveTransform(PLATE_DOTS_U[CORNERS].astype(np.float32), dots_px[CORNERS].astype(np.float32))
    np.testing.assert_allclose(apply_plainly(opencv, PLATE_DOTS_U), dots_px, atol=0.01)  # float32 corners


def test_corners_in_line_give_finite_numbers() -> None:
    in_line = np.array([[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], [[5.0, 5.0]] * 4])
    assert np.isfinite(image_from_corner_dots(in_line)).all()


@given(homography=views, weights=st.lists(st.floats(0.1, 1.0), min_size=16, max_size=16))
def test_a_fit_of_exact_points_is_exact_whatever_the_weights(homography: np.ndarray, weights: list[float]) -> None:
    dots_px = apply_plainly(homography, PLATE_DOTS_U)[None]
    fitted = fit_homographies(PLATE_DOTS_U, dots_px, np.array([weights]))
    np.testing.assert_allclose(apply_homographies(fitted, PLATE_DOTS_U), dots_px, atol=FIT_TOLERANCE_PX)


@given(homography=views, out=st.permutations(range(16)), count=st.integers(1, 8))
def test_points_of_no_weight_have_no_say(homography: np.ndarray, out: list[int], count: int) -> None:
    spoilt_px = apply_plainly(homography, PLATE_DOTS_U)
    true_px = spoilt_px.copy()
    weights = np.ones((1, 16))
    weights[0, out[:count]] = 0.0
    spoilt_px[out[:count]] += 50.0
    fitted = fit_homographies(PLATE_DOTS_U, spoilt_px[None], weights)
    np.testing.assert_allclose(apply_homographies(fitted, PLATE_DOTS_U)[0], true_px, atol=FIT_TOLERANCE_PX)


def test_the_fit_is_the_least_squares_one() -> None:
    """Compared with the minimum of the reprojection error, which the linear equations only approximate."""
    rng = np.random.default_rng(1)
    homography = image_from_plate(0.8, 1.0, 2.0, 200.0)
    dots_px = apply_plainly(homography, PLATE_DOTS_U)
    sigma_px, trials = 0.05, 400
    noisy_px = dots_px + rng.normal(0.0, sigma_px, (trials, 16, 2))
    fitted = fit_homographies(PLATE_DOTS_U, noisy_px, np.ones((trials, 16)))
    residual_px = noisy_px - apply_homographies(fitted, PLATE_DOTS_U)
    # Eight of the 32 coordinates are used up; a sum of squares over 400 x 24 scatters by sqrt(2 / 9,600) = 1.4 %.
    variance = (residual_px**2).sum() / (trials * (32 - 8)) / sigma_px**2
    assert abs(variance - 1.0) < 4 * np.sqrt(2.0 / (trials * 24))


def test_weights_are_inverse_variances() -> None:
    rng = np.random.default_rng(2)
    homography = image_from_plate(0.5, 1.0, 2.0, 200.0)
    dots_px = apply_plainly(homography, PLATE_DOTS_U)
    sigmas_px = np.where(np.arange(16) % 2, 0.5, 0.05)[:, None]
    noisy_px = dots_px + sigmas_px * rng.normal(size=(300, 16, 2))

    def rmse_px(weights: np.ndarray) -> float:
        fitted = fit_homographies(PLATE_DOTS_U, noisy_px, np.broadcast_to(weights, (300, 16)))
        return float(np.sqrt(((apply_homographies(fitted, PLATE_DOTS_U) - dots_px) ** 2).mean()))

    assert rmse_px(sigmas_px[:, 0] ** -2 * sigmas_px.min() ** 2) < 0.4 * rmse_px(np.ones(16))


@settings(max_examples=50)
@given(homography=views)
def test_jacobians_are_the_differences(homography: np.ndarray) -> None:
    jacobians = homography_jacobians(homography[None], PLATE_DOTS_U)[0]
    step_u = 1e-4
    for axis in range(2):
        step = step_u * np.eye(2)[axis]
        forth, back = apply_plainly(homography, PLATE_DOTS_U + step), apply_plainly(homography, PLATE_DOTS_U - step)
        np.testing.assert_allclose(jacobians[..., axis], (forth - back) / (2 * step_u), rtol=1e-5, atol=1e-5)


@settings(max_examples=50)
@given(homography=views)
def test_a_squares_picture_has_the_area_of_its_scale(homography: np.ndarray) -> None:
    half_u = 0.005
    square = half_u * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    x, y = apply_plainly(homography, square).T
    area_px2 = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    scale = local_px_per_u(homography[None])
    np.testing.assert_allclose(scale, [np.sqrt(area_px2) / (2 * half_u)], rtol=1e-4)
    np.testing.assert_allclose(scale, area_scales(homography_jacobians(homography[None], np.zeros((1, 2))))[:, 0])


def test_turns_are_clockwise_as_seen() -> None:
    right, down = np.array([1.0, 0.0]), np.array([0.0, 1.0])  # y is down in a picture
    assert cross(right, down) == 1.0 and cross(down, right) == -1.0
