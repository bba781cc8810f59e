import cv2
import numpy as np
import pytest

from app.targets.drawing import BLACK_RGB, GREEN_RGB, RED_RGB, WHITE_RGB
from app.targets.layout import BASE_CELLS
from app.vision.dots import Blobs, DotOptions, find_red_blobs, sample_rows
from tests.vision.scenes import Shot

SUPERSAMPLING = 8
LENS_SIGMA_PX = 0.7
Ellipse = tuple[float, float, float, float, float]  # x, y, semi-axes, turn


def painted(
    ellipses: list[Ellipse], rgb: tuple[int, int, int] = RED_RGB, ground_rgb: tuple[int, int, int] = BLACK_RGB
) -> np.ndarray:
    """Ellipses on a plain ground, 120 x 160, edges by area, a little blur."""
    row, column = (np.mgrid[0 : 120 * SUPERSAMPLING, 0 : 160 * SUPERSAMPLING] + 0.5) / SUPERSAMPLING - 0.5
    inside = np.zeros(row.shape, dtype=bool)
    for x, y, major, minor, turn in ellipses:
        along = (column - x) * np.cos(turn) + (row - y) * np.sin(turn)
        across = (row - y) * np.cos(turn) - (column - x) * np.sin(turn)
        inside |= (along / major) ** 2 + (across / minor) ** 2 <= 1.0
    share = inside.reshape(120, SUPERSAMPLING, 160, SUPERSAMPLING).mean(axis=(1, 3))[..., None]
    picture = np.array(ground_rgb) + share * (np.array(rgb) - np.array(ground_rgb))
    smooth = cv2.GaussianBlur(picture, (0, 0), LENS_SIGMA_PX)
    return np.rint(smooth[..., ::-1]).astype(np.uint8)


def only(blobs: Blobs) -> tuple[np.ndarray, np.ndarray]:
    assert len(blobs) == 1
    return blobs.centres_px[0], blobs.semi_axes_px[0]


@pytest.mark.parametrize(
    "ellipse",
    [
        (60.3, 50.7, 3.0, 3.0, 0.0),
        (60.3, 50.7, 8.0, 8.0, 0.0),
        (80.5, 61.25, 12.0, 6.0, 0.4),
        (80.5, 61.25, 6.0, 3.0, 2.0),
        (70.0, 60.0, 40.0, 30.0, 1.0),
    ],
)
def test_a_red_ellipse_is_found_with_its_size(ellipse: Ellipse) -> None:
    centre_px, semi_axes_px = only(find_red_blobs(painted([ellipse])))
    # Outlines run along whole pixels: a proposal is good to a part of a dot.
    np.testing.assert_allclose(centre_px, ellipse[:2], atol=0.25)
    np.testing.assert_allclose(semi_axes_px, ellipse[2:4], rtol=0.14, atol=0.15)


@pytest.mark.parametrize("rgb", [GREEN_RGB, WHITE_RGB, (60, 60, 200), (128, 128, 128)])
def test_other_colours_are_not_red(rgb: tuple[int, int, int]) -> None:
    assert len(find_red_blobs(painted([(60.0, 50.0, 8.0, 8.0, 0.0)], rgb))) == 0


def test_a_picture_without_anything_has_no_blob() -> None:
    for grey in (0, 128, 255):
        blobs = find_red_blobs(np.full((48, 64, 3), grey, dtype=np.uint8))
        assert blobs.centres_px.shape == (0, 2) and blobs.semi_axes_px.shape == (0, 2)
    assert len(find_red_blobs(np.zeros((1, 1, 3), dtype=np.uint8))) == 0


def test_red_that_does_not_end_around_it_is_no_dot() -> None:
    """A red wall, and a stripe across the picture."""
    assert len(find_red_blobs(np.full((120, 160, 3), RED_RGB[::-1], dtype=np.uint8))) == 0
    stripe = painted([])
    stripe[50:60] = RED_RGB[::-1]
    assert len(find_red_blobs(stripe)) == 0


def test_dots_whose_skirts_touch_are_parted() -> None:
    """Two dots of a small plate with red all the way between them: without their peaks they were one."""
    places = [(40.0, 40.0), (47.0, 40.0)]
    blurred = cv2.GaussianBlur(painted([(x, y, 2.0, 2.0, 0.0) for x, y in places]), (0, 0), 1.2)
    blobs = find_red_blobs(blurred)
    assert len(blobs) == 2
    for place in places:
        assert np.linalg.norm(blobs.centres_px - place, axis=1).min() < 0.6


@pytest.mark.parametrize("gains", [(1.0, 1.0, 1.0), (1.0, 0.85, 0.6), (0.75, 0.95, 1.0), (0.35, 0.35, 0.35)])
def test_a_cast_or_dim_light_hides_no_dot_and_makes_none(gains: tuple[float, float, float]) -> None:
    """Red, green and white dots on a plate on white paper, as the light colours them."""
    picture = np.full((120, 160, 3), 235.0)
    picture[20:100, 20:140] = BLACK_RGB
    for x, rgb in ((50, RED_RGB), (80, GREEN_RGB), (110, WHITE_RGB)):
        cv2.circle(picture, (x, 60), 6, tuple(float(value) for value in rgb), -1, cv2.LINE_AA)
    lit = np.rint(cv2.GaussianBlur(picture * gains, (0, 0), LENS_SIGMA_PX)[..., ::-1]).astype(np.uint8)
    centre_px, _ = only(find_red_blobs(lit))
    np.testing.assert_allclose(centre_px, [50.0, 60.0], atol=0.5)


def test_the_strongest_are_kept_when_there_are_too_many() -> None:
    weak = painted([(40.0, 60.0, 6.0, 6.0, 0.0)], (110, 30, 34))
    strong = painted([(120.0, 60.0, 6.0, 6.0, 0.0)])
    picture = np.maximum(weak, strong)
    assert len(find_red_blobs(picture)) == 2
    centre_px, _ = only(find_red_blobs(picture, DotOptions(blobs_max=1)))
    np.testing.assert_allclose(centre_px, [120.0, 60.0], atol=0.25)


def test_noise_alone_makes_few_dots_and_does_not_break_one() -> None:
    noise = np.random.default_rng(1).normal(0.0, 8.0, (120, 160, 3))
    noisy = np.clip(painted([(60.0, 50.0, 8.0, 8.0, 0.0)]) + noise, 0, 255).astype(np.uint8)
    away_px = np.linalg.norm(find_red_blobs(noisy).centres_px - [60.0, 50.0], axis=1)
    assert (away_px < 8.0).sum() == 1 and away_px.min() < 0.5


def test_every_base_dot_of_a_photograph_is_proposed(plates_shot: Shot) -> None:
    blobs = find_red_blobs(plates_shot.bgr)
    base_px = np.concatenate([target.dots_px[list(BASE_CELLS)] for target in plates_shot.truth])
    away_px = np.linalg.norm(blobs.centres_px[:, None] - base_px, axis=2).min(axis=0)
    assert len(base_px) == 5 * 24 and away_px.max() < 1.0  # a quarter of a radius of 4 px
    assert len(blobs) == len(base_px)


def test_samples_are_bilinear_however_many() -> None:
    row, column = np.mgrid[0:50, 0:60]
    ramp = np.stack([2 * column, 3 * row, column + row], axis=-1).astype(np.uint8)
    points_px = np.random.default_rng(2).uniform(0.0, 48.0, (70_000, 2, 2))  # more rows than OpenCV takes at once
    x, y = np.moveaxis(points_px, 2, 0)
    expected = np.stack([2 * x, 3 * y, x + y], axis=-1)
    # 8-bit results are rounded, and OpenCV interpolates in steps of 1/32 px.
    np.testing.assert_allclose(sample_rows(ramp, points_px), expected, atol=0.5 + 3 / 32)
    np.testing.assert_array_equal(sample_rows(ramp[..., 0].copy(), points_px[:5]).shape, (5, 2))
