import cv2
import numpy as np
import pytest

from app.vision.kernels.halving import MARGIN_PX, blocks_around, halved

REACH_U = 6.4


def noise(height: int, width: int) -> np.ndarray:
    return np.random.default_rng(2).integers(0, 256, (height, width, 3), dtype=np.uint8)


@pytest.mark.parametrize("halvings", [1, 2, 3])
def test_each_halving_takes_the_rounded_mean_of_four(halvings: int) -> None:
    picture = noise(88, 104)
    expected = picture
    for _ in range(halvings):
        half = (expected.shape[1] // 2, expected.shape[0] // 2)
        expected = cv2.resize(expected, half, interpolation=cv2.INTER_AREA)
    rows, columns, _ = expected.shape
    np.testing.assert_array_equal(halved(picture, (0, columns, 0, rows), halvings), expected)


@pytest.mark.parametrize("halvings", [1, 2, 3])
def test_a_part_is_what_the_whole_has_there(halvings: int) -> None:
    picture, block = noise(203, 301), 2**halvings
    whole = halved(picture, (0, 301 // block, 0, 203 // block), halvings)
    part = halved(picture, (5, 9, 3, 20), halvings)
    np.testing.assert_array_equal(part, whole[3:20, 5:9])


def plate_at(px_per_u: float, x_px: float, y_px: float, tilt: float = 0.0) -> np.ndarray:
    return np.array([[px_per_u, 0.0, x_px], [0.0, px_per_u, y_px], [tilt, 0.0, 1.0]])


def test_the_blocks_hold_the_patch_and_a_margin() -> None:
    left, right, top, bottom = blocks_around(plate_at(10.0, 301.0, 402.0), REACH_U, 2, (400, 400))
    assert (left, right) == ((301 - 64) // 2 - MARGIN_PX, -(-(301 + 64) // 2) + MARGIN_PX)
    assert (top, bottom) == ((402 - 64) // 2 - MARGIN_PX, (402 + 64) // 2 + MARGIN_PX)


@pytest.mark.parametrize("x_px", [-1e9, -500.0, 0.0, 99.0, 600.0, 1e9, np.inf, np.nan])
@pytest.mark.parametrize("tilt", [0.0, 1.0 / REACH_U, 1.0])
@pytest.mark.parametrize("count", [1, 2, 7])
def test_wherever_a_plate_lies_the_blocks_are_in_the_picture(x_px: float, tilt: float, count: int) -> None:
    """Also those of a plate that reaches behind the camera, two of them where there are two."""
    left, right, top, bottom = blocks_around(plate_at(10.0, x_px, 5.0, tilt), REACH_U, 2, (count, 3))
    assert 0 <= left < right <= count and 0 <= top < bottom <= 3
    assert right - left >= min(count, 2) and bottom - top >= 2
