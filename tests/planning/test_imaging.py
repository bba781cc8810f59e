from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.planning.imaging import ImagingOptions, blur_kernel, digitise, expose
from app.planning.tone import srgb_of_linear

PLAIN = ImagingOptions(
    lens_sigma_px=0.0, vignetting=0.0, full_well_electrons=0.0, contrast=0.0, white_balance_rgb=(1.0, 1.0, 1.0)
)


def grey(level: float, size: int = 64) -> np.ndarray:
    return np.full((size, size, 3), level, dtype=np.float32)


@given(radius_px=st.floats(0.0, 3.0), x_px=st.floats(-6.0, 6.0), y_px=st.floats(-6.0, 6.0))
def test_blur_loses_no_light_and_moves_nothing(radius_px: float, x_px: float, y_px: float) -> None:
    kernel = blur_kernel(radius_px, (x_px, y_px)).astype(np.float64)
    along = np.arange(len(kernel)) - len(kernel) // 2
    assert kernel.sum() == pytest.approx(1.0, abs=1e-6)
    assert abs(kernel.sum(axis=0) @ along) < 1e-6 and abs(kernel.sum(axis=1) @ along) < 1e-6


def test_motion_spreads_as_a_uniform_line_and_defocus_as_a_disc() -> None:
    line = blur_kernel(0.0, (9.0, 0.0)).astype(np.float64)
    along = np.arange(len(line)) - len(line) // 2
    # Variance of a line of length 9 and of a pixel: 81 / 12 + 1 / 12; a line drawn 1/16 px thick adds next to nothing.
    assert line.sum(axis=0) @ along**2 == pytest.approx(82 / 12, rel=0.02)
    disc = blur_kernel(3.0, (0.0, 0.0)).astype(np.float64)
    along = np.arange(len(disc)) - len(disc) // 2
    assert disc.sum(axis=0) @ along**2 == pytest.approx(9 / 4 + 1 / 12, rel=0.02)


def test_no_blur_is_one_pixel() -> None:
    assert blur_kernel(0.0, (0.0, 0.0)).tolist() == [[1.0]]


def test_metering_brings_the_scene_to_its_level_whatever_the_light() -> None:
    for light in (0.01, 5.0):
        assert expose(grey(light), PLAIN).mean() == pytest.approx(PLAIN.metered_level, rel=1e-4)
    brighter = expose(grey(1.0), replace(PLAIN, exposure_ev=1.0))
    assert brighter.mean() == pytest.approx(2 * PLAIN.metered_level, rel=1e-4)


def test_white_balance_is_a_gain_of_each_channel() -> None:
    sensor = expose(grey(1.0), replace(PLAIN, white_balance_rgb=(1.2, 1.0, 0.8)))
    np.testing.assert_allclose(sensor[5, 5] / sensor[5, 5, 1], [1.2, 1.0, 0.8], rtol=1e-5)


def test_corners_lose_what_the_vignetting_says() -> None:
    sensor = expose(grey(1.0, 65), replace(PLAIN, vignetting=0.3))
    assert sensor[0, 0, 0] / sensor[32, 32, 0] == pytest.approx(0.7, rel=1e-5)
    np.testing.assert_allclose(sensor, sensor[::-1, ::-1], rtol=1e-6)


def test_noise_has_the_variance_of_photons_and_reading() -> None:
    level, full_well, read = 0.2, 1_000.0, 8.0
    imaging = replace(PLAIN, full_well_electrons=full_well, read_noise_electrons=read)
    pixels = digitise(grey(level, 300), imaging, np.random.default_rng(2)).astype(float) / 255
    step = 1e-4
    slope = float(srgb_of_linear(level + step) - srgb_of_linear(level - step)) / (2 * step)
    expected = slope * np.sqrt(level / full_well + (read / full_well) ** 2)
    rounding = 1 / 255 / np.sqrt(12)
    # 270,000 samples fix a deviation to 0.14 %; the curve's bend within the noise changes it by about a per cent.
    assert pixels.std() == pytest.approx(np.hypot(expected, rounding), rel=0.03)


def test_noise_is_that_of_the_seed() -> None:
    imaging = replace(PLAIN, full_well_electrons=1_000.0)
    first, again, other = (digitise(grey(0.3), imaging, np.random.default_rng(seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_light_beyond_the_full_well_is_white_and_sharpening_overshoots_edges() -> None:
    assert (digitise(grey(3.0), PLAIN, np.random.default_rng(0)) == 255).all()
    edge = grey(0.1)
    edge[:, 32:] = 0.4
    rng = np.random.default_rng(0)
    plain, sharp = digitise(edge, PLAIN, rng), digitise(edge, replace(PLAIN, sharpening=0.5), rng)
    assert sharp[10, 31, 0] < plain[10, 31, 0] and sharp[10, 32, 0] > plain[10, 32, 0]
    assert sharp[10, 5, 0] == plain[10, 5, 0]


def test_glare_adds_a_share_of_the_mean_light_everywhere() -> None:
    light = np.zeros((20, 30, 3), dtype=np.float32)
    light[:, :15] = 1.0
    imaging = ImagingOptions(lens_sigma_px=0.0, vignetting=0.0, veiling_glare=0.1)
    sensor = expose(light, imaging)
    assert sensor[0, -1, 0] / sensor[0, 0, 0] == pytest.approx(0.05 / 1.05, rel=1e-5)
