from dataclasses import replace

import numpy as np
import pytest

from app.planning.imaging import ImagingOptions
from app.planning.scene import Scene
from app.planning.tone import develop
from app.targets.digits import digits_of_code
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.centres import DotCentres, locate_dots
from app.vision.detector import DetectorOptions, detect
from app.vision.inks import read_inks
from app.vision.kernels.profiles import BLUR_STEP_U, edge_profiles, grey_values
from app.vision.measurement import PlateFits, SizedPatches
from app.vision.patches import Pyramid
from app.vision.settling import SettlingOptions, edge_table, grey_curve, settle_dots, settled_plates
from app.vision.template import blurred_disc
from tests.vision.scenes import (
    NOISELESS,
    Shot,
    before_wall,
    measured_errors,
    photographs,
    plates_in_rows,
    sensor_shots,
    true_homographies,
)

PX_PER_U = 6.0
BLUR_PX = 0.75  # the lens's 0.7 and the pixel's box
GREY_NOISE, LOUD_NOISE = 6.0, 12.0  # the louder drowns what else a centre errs by
FROM_SAMPLES = DetectorOptions(settling=SettlingOptions(px_per_u_min=np.inf))


@pytest.fixture(scope="module")
def scene(codes: np.ndarray) -> Scene:
    return before_wall(plates_in_rows(codes, (4, 3), PX_PER_U, seed=3, slant_deg=50.0))


@pytest.fixture(scope="module")
def sharp(scene: Scene) -> Shot:
    return sensor_shots(scene, NOISELESS, [1])[0]


def with_noise(shot: Shot, seed: int, sigma: float = GREY_NOISE) -> Shot:
    """Noise that is even in grey values, the same in all channels."""
    noise = sigma * np.random.default_rng(seed).standard_normal(shot.bgr.shape)
    return replace(shot, bgr=np.clip(np.rint(shot.bgr + noise), 0, 255).astype(np.uint8))


def located(shot: Shot) -> tuple[PlateFits, DotCentres]:
    fits = SizedPatches.of(Pyramid.of(shot.bgr, 2), true_homographies(shot)).fit(BLUR_PX)
    return fits, locate_dots(fits, read_inks(fits.amplitudes), (640, 480))


def errors_of(shot: Shot, dots: DotCentres) -> np.ndarray:
    return (dots.centres_px - np.stack([target.dots_px for target in shot.truth]))[dots.measured]


@pytest.mark.parametrize("blur_u", [0.12, 0.304, 0.895])
def test_edges_are_those_of_the_template(blur_u: float) -> None:
    radii_u = np.linspace(0.01, 2.5, 60)
    offsets, found = np.zeros((2, 60), dtype=np.float32), np.empty((3, 60), dtype=np.float32)
    offsets[0] = radii_u
    even = tuple(np.float32(number) for number in (0.0, 0.0, 1.0, 0.0, 0.0, 1.0, blur_u))
    edge_profiles(offsets, even, edge_table(), np.empty(60, dtype=np.int32), found)
    expected = blurred_disc(radii_u, blur_u)
    # Linear between twentieths of a standard deviation: a second derivative of 0.24 over eight times 400. The level of
    # blur is half a step away at most, and a dot's middle changes by three quarters of that where it is most.
    np.testing.assert_allclose(found[0], expected[0], atol=1e-3 + 0.75 * BLUR_STEP_U / 2)
    np.testing.assert_allclose(-found[1], expected[1], atol=0.03 / blur_u)
    assert not found[2].any()


def test_grey_values_are_those_that_a_plain_camera_writes() -> None:
    light = np.linspace(0.0, 1.0, 2001, dtype=np.float32)
    shown, slopes = 255 * light, np.empty(2001, dtype=np.float32)
    grey_values(grey_curve(), 2001, shown, slopes)
    np.testing.assert_allclose(shown, develop(light, 0.0), atol=0.52)  # whole grey values there
    # One difference reaches over the bend between line and curve.
    np.testing.assert_allclose(slopes[1:-1], np.gradient(shown, 255 * light)[1:-1], atol=0.2, rtol=0.01)


def test_what_saturates_does_not_change() -> None:
    shown, slopes = np.array([300.0, -1.0], dtype=np.float32), np.empty(2, dtype=np.float32)
    grey_values(grey_curve(), 2, shown, slopes)
    np.testing.assert_allclose(shown, [255.0, 0.0], atol=0.02)
    assert not slopes.any()


def test_pixels_place_dots_better_than_samples(sharp: Shot) -> None:
    shot = with_noise(sharp, 1)
    fits, dots = located(shot)
    before, after = errors_of(shot, dots), errors_of(shot, settle_dots(shot.bgr, fits, dots, BLUR_PX))
    assert np.sqrt((after**2).mean()) < 0.8 * np.sqrt((before**2).mean())
    standard_error_px = np.sqrt((after**2).mean() / len(after))
    assert np.abs(after.mean(axis=0)).max() < 4 * standard_error_px


def test_information_is_what_the_noise_allows(sharp: Shot) -> None:
    """Where noise is even and independent from pixel to pixel and channel to channel, errors have the stated size."""
    # Of luma, by the sum of its squared weights; both chromas have nearly the same.
    options = SettlingOptions(noise_grey=LOUD_NOISE * np.sqrt(0.447), chroma_weight=1.0)
    squares = []
    for seed in (1, 2):
        shot = with_noise(sharp, seed, LOUD_NOISE)
        fits, dots = located(shot)
        settled = settle_dots(shot.bgr, fits, dots, BLUR_PX, options)
        covariances_px2 = settled.px_by_u @ settled.covariances_u2 @ np.swapaxes(settled.px_by_u, -1, -2)
        errors_px = errors_of(shot, settled)
        weights = np.linalg.inv(covariances_px2[settled.measured])
        squares.append(np.einsum("ni,nij,nj->n", errors_px, weights, errors_px) / 2)
    normalised = np.concatenate(squares)
    # Luma and blue chroma are correlated by 0.45, which the weights leave out; amplitudes are known to a few per cent.
    assert abs(normalised.mean() - 1.0) < 0.45 + 4 / np.sqrt(len(normalised))


def test_one_step_takes_a_dot_to_its_place(sharp: Shot) -> None:
    fits, dots = located(sharp)
    away = replace(dots, centres_px=dots.centres_px + np.array([0.1, -0.08]))
    errors_px = errors_of(sharp, settle_dots(sharp.bgr, fits, away, BLUR_PX))
    assert np.abs(errors_px.mean(axis=0)).max() < 0.01
    assert np.sqrt((errors_px**2).mean()) < 0.02


def test_small_plates_are_left_to_the_samples(sharp: Shot) -> None:
    fits, dots = located(sharp)
    larger = SettlingOptions(px_per_u_min=2.0 * PX_PER_U)
    assert not settled_plates(fits, larger).any()
    assert settle_dots(sharp.bgr, fits, dots, BLUR_PX, larger) is dots


def test_steps_that_are_too_long_are_not_believed(sharp: Shot) -> None:
    fits, dots = located(sharp)
    nowhere = SettlingOptions(step_max_u=0.0)
    np.testing.assert_array_equal(settle_dots(sharp.bgr, fits, dots, BLUR_PX, nowhere).centres_px, dots.centres_px)


def inks_of(code: int) -> np.ndarray:
    inks = np.full(16, 3)
    inks[list(DIGIT_CELLS)] = digits_of_code(code)
    assert (inks[list(BASE_CELLS)] == 3).all()
    return inks


@pytest.mark.parametrize(
    "change", [{"exposure_ev": 1.0}, {"exposure_ev": -1.5}, {"lens_sigma_px": 1.2}, {"jpeg_quality": 70}]
)
def test_no_ink_is_biased_by_exposure_blur_or_compression(
    scene: Scene, family: CodeFamily, change: dict[str, float]
) -> None:
    shot = photographs(scene, [ImagingOptions(**change)])[0]  # type: ignore[arg-type]
    detection = detect(shot.bgr, family)
    for ink in (1, 2, 3):
        errors = [
            (target.centres_px - shot.dots_px(target.code))[target.measured & (inks_of(target.code) == ink)]
            for target in detection.targets
        ]
        errors_px = np.concatenate(errors)
        assert np.abs(errors_px.mean(axis=0)).max() < 4 * np.sqrt((errors_px**2).mean() / len(errors_px)) + 0.003


def test_a_files_dots_are_placed_better_by_their_pixels(scene: Scene, family: CodeFamily) -> None:
    shot = photographs(scene, [ImagingOptions(full_well_electrons=600.0)])[0]
    settled, _ = measured_errors(detect(shot.bgr, family), shot)
    sampled, _ = measured_errors(detect(shot.bgr, family, FROM_SAMPLES), shot)
    assert np.sqrt((settled**2).mean()) < np.sqrt((sampled**2).mean())
