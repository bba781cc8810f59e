import numpy as np
import pytest

from app.vision.kernels.neighbours import NONE, find_nearest

AREA_RATIO_MAX = 3.5


def brute_force(centres_px: np.ndarray, areas: np.ndarray, count: int) -> np.ndarray:
    away_px = np.linalg.norm(centres_px[:, None] - centres_px, axis=2)
    ratio = areas[:, None] / areas
    away_px[(ratio >= AREA_RATIO_MAX) | (ratio <= 1.0 / AREA_RATIO_MAX) | np.eye(len(areas), dtype=bool)] = np.inf
    order = np.argsort(away_px, axis=1)[:, :count]
    order = np.pad(order, ((0, 0), (0, max(0, count - order.shape[1]))))
    found = np.pad(np.sort(away_px, axis=1), ((0, 0), (0, count)), constant_values=np.inf)[:, :count]
    return np.where(np.isfinite(found), order, NONE)


@pytest.mark.parametrize("blobs", [1, 2, 7, 300])
@pytest.mark.parametrize("spread", [(900.0, 20.0), (20.0, 900.0), (500.0, 400.0)])
def test_the_nearest_of_like_size_nearest_first(blobs: int, spread: tuple[float, float]) -> None:
    rng = np.random.default_rng(blobs)
    centres_px = rng.uniform(0.0, 1.0, (blobs, 2)) * spread
    semi_axes_px = np.exp(rng.uniform(0.0, 1.5, (blobs, 2)))
    nearest = np.empty((blobs, 12), dtype=np.int64)
    find_nearest(centres_px, semi_axes_px, AREA_RATIO_MAX, nearest)
    np.testing.assert_array_equal(nearest, brute_force(centres_px, semi_axes_px.prod(axis=1), 12))
