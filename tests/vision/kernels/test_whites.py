import numpy as np
import pytest

from app.vision.kernels.whites import brighter_than


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8, 1.0])
@pytest.mark.parametrize("shape", [(1, 1, 3), (50, 97, 3)])
def test_each_channel_has_its_own_order(shape: tuple[int, ...], share: float) -> None:
    picture = np.random.default_rng(5).integers(0, 256, shape, dtype=np.uint8)
    sparse = np.sort(picture[::4, ::4].reshape(-1, 3), axis=0)
    assert brighter_than(picture, 4, share) == tuple(sparse[int(share * (len(sparse) - 1))])
