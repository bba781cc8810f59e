import numpy as np
import pytest

from app.planning.tone import develop, linear_of_srgb, srgb_of_linear

LEVELS = np.arange(256)


def test_the_curve_and_its_inverse_cancel() -> None:
    np.testing.assert_allclose(srgb_of_linear(linear_of_srgb(LEVELS)) * 255, LEVELS, atol=1e-9)


def test_known_points_of_the_srgb_curve() -> None:
    # IEC 61966-2-1: 18 % grey is level 118; half of the scale is 21.4 % of the light.
    assert round(float(srgb_of_linear(0.18)) * 255) == 118
    assert float(linear_of_srgb(127.5)) == pytest.approx(0.214, abs=5e-4)


def test_plain_development_returns_every_level() -> None:
    np.testing.assert_array_equal(develop(linear_of_srgb(LEVELS).astype(np.float32), contrast=0.0), LEVELS)


@pytest.mark.parametrize("contrast", [0.0, 0.3, 1.0])
def test_development_never_reverses_and_keeps_black_and_white(contrast: float) -> None:
    levels = develop(np.linspace(-0.5, 1.5, 5_000, dtype=np.float32), contrast).astype(int)
    assert (np.diff(levels) >= 0).all() and levels[0] == 0 and levels[-1] == 255


def test_contrast_darkens_shadows_and_lifts_lights() -> None:
    dark, light = np.float32(0.02), np.float32(0.6)
    assert develop(dark, 0.4) < develop(dark, 0.0) and develop(light, 0.4) > develop(light, 0.0)
