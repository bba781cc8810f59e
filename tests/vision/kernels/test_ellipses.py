import numpy as np
import pytest

from app.vision.kernels.ellipses import fit_ellipses

ANGLE_RAD = 0.6


def moments_of(inside: np.ndarray) -> np.ndarray:
    y, x = np.nonzero(inside)
    return np.array([len(x), x.sum(), y.sum(), (x * x).sum(), (y * y).sum(), (x * y).sum()], dtype=np.float64)


def ellipse(major_px: float, minor_px: float) -> np.ndarray:
    y, x = np.mgrid[0:120, 0:140] - np.array([55.3, 71.8])[:, None, None]
    along, across = x * np.cos(ANGLE_RAD) + y * np.sin(ANGLE_RAD), y * np.cos(ANGLE_RAD) - x * np.sin(ANGLE_RAD)
    return np.asarray((along / major_px) ** 2 + (across / minor_px) ** 2 < 1.0)


def test_an_ellipse_is_found_and_what_cannot_be_a_dot_is_left_out() -> None:
    round_one, long_one, speck = ellipse(20.0, 12.0), ellipse(40.0, 5.0), np.eye(2)
    moments = np.stack([moments_of(shape) for shape in (speck, long_one, round_one)])
    centres_px, semi_axes_px = np.empty((2, 3, 2))
    assert fit_ellipses(moments, (6.0, 1000.0, 6.0), centres_px, semi_axes_px) == 1
    # Some 90 pixels stand on the border, each in or out at random.
    np.testing.assert_allclose(centres_px[0], [71.8, 55.3], atol=0.1)
    np.testing.assert_allclose(semi_axes_px[0], [20.0, 12.0], atol=0.2)
    assert fit_ellipses(moments, (1.0, 1000.0, 9.0), centres_px, semi_axes_px) == 3


@pytest.mark.parametrize("count", [0, 1])
def test_single_pixels_are_round(count: int) -> None:
    centres_px, semi_axes_px = np.empty((2, count, 2))
    moments = np.tile([1.0, 7.0, 3.0, 49.0, 9.0, 21.0], (count, 1))
    assert fit_ellipses(moments, (1.0, 9.0, 6.0), centres_px, semi_axes_px) == count
    np.testing.assert_allclose(semi_axes_px, 2.0 * np.sqrt(1.0 / 12.0))
