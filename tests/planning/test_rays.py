import numpy as np
import pytest

from app.geometry.camera import Camera
from app.planning.rays import RayGrid
from app.planning.survey_plan import phone_camera


@pytest.mark.parametrize("size_px", [(640, 480), (1920, 1080), (33, 20)])
def test_the_spline_is_the_lens_model(size_px: tuple[int, int]) -> None:
    camera = phone_camera(*size_px)
    rng = np.random.default_rng(1)
    columns_px = np.sort(rng.uniform(-0.5, size_px[0] - 0.5, 40))
    rows_px = np.sort(rng.uniform(-0.5, size_px[1] - 0.5, 30))
    x, y = RayGrid(camera).at(columns_px, rows_px)
    image_px = camera.project(np.stack([x, y, np.ones_like(x)], axis=-1))
    # What the spline and the lens model's own inverse leave; a thousandth of it would be felt by no measurement.
    np.testing.assert_allclose(image_px, np.stack(np.meshgrid(columns_px, rows_px), axis=-1), atol=1e-4)


def test_a_lens_without_distortion_is_a_plane() -> None:
    camera = Camera(64, 48, np.array([50.0, 60.0, 31.0, 24.0, 0, 0, 0, 0, 0]))
    x, y = RayGrid(camera).at(np.array([31.0, 41.0]), np.array([24.0]))
    np.testing.assert_allclose(x, [[0.0, 0.2]], atol=1e-12)
    np.testing.assert_allclose(y, [[0.0, 0.0]], atol=1e-12)
