import numpy as np
import pytest

from app.vision.kernels.sampling import LIGHT_DEGREE, sample_plates

AXIS_U = np.linspace(-6.0, 6.0, 17)
GREY = np.array([0, 1] + [0] * (LIGHT_DEGREE - 1) + [0, 1], dtype=np.float32)  # light is as coded
HEIGHT_PX, WIDTH_PX = 90, 120


def samples_of(level: np.ndarray, homography: np.ndarray, px_per_u_max: float = np.inf) -> np.ndarray:
    """Samples of one plate, shape (3, N)."""
    samples, bounds = np.empty((1, 3, len(AXIS_U) ** 2), dtype=np.float32), (px_per_u_max, 3, AXIS_U[-1])
    written = (samples, np.empty(1), np.empty(1, dtype=np.int64))
    sample_plates(level, homography[None], bounds, (AXIS_U, GREY), written)
    return np.asarray(samples[0])


def bilinear(level: np.ndarray, points_px: np.ndarray) -> np.ndarray:
    """Samples of shape (3, N) at points of shape (N, 2); the border goes on beyond the picture."""
    x, y = np.clip(points_px, 0.0, [WIDTH_PX - 1.0, HEIGHT_PX - 1.0]).T
    left, top = x.astype(int), y.astype(int)
    right, bottom = np.minimum(left + 1, WIDTH_PX - 1), np.minimum(top + 1, HEIGHT_PX - 1)
    along, down = (x - left)[:, None], (y - top)[:, None]
    upper = level[top, left] * (1.0 - along) + level[top, right] * along
    lower = level[bottom, left] * (1.0 - along) + level[bottom, right] * along
    return np.asarray((upper * (1.0 - down) + lower * down).T)


@pytest.mark.parametrize("middle_px", [(60.0, 45.0), (8.0, 45.0), (116.0, 86.0)])
def test_samples_are_bilinear_inside_and_over_the_border(middle_px: tuple[float, float]) -> None:
    level = np.random.default_rng(3).integers(0, 256, (HEIGHT_PX, WIDTH_PX, 3), dtype=np.uint8)
    homography = np.array([[2.5, 0.4, middle_px[0]], [-0.3, 2.2, middle_px[1]], [0.01, -0.02, 1.0]])
    samples = samples_of(level, homography)
    x, y = (part.ravel() for part in np.meshgrid(AXIS_U, AXIS_U))
    along, down, depth = homography @ np.stack([x, y, np.ones(len(x))])
    expected = bilinear(level, np.stack([along / depth, down / depth], axis=1))
    np.testing.assert_allclose(samples, expected, atol=0.01)


@pytest.mark.parametrize("px_per_u_max", [np.inf, 1.0])
@pytest.mark.parametrize("behind", [np.nan, 0.0, -0.2])
def test_a_plate_behind_the_camera_takes_pixels_of_the_picture(behind: float, px_per_u_max: float) -> None:
    level = np.random.default_rng(4).integers(7, 9, (HEIGHT_PX, WIDTH_PX, 3), dtype=np.uint8)
    homography = np.array([[2.5, 0.4, 60.0], [-0.3, 2.2, 45.0], [0.2, behind, behind]])
    samples = samples_of(level, homography, px_per_u_max)
    assert samples.min() >= 7.0 and samples.max() <= 8.0
