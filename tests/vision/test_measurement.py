from dataclasses import fields

import numpy as np
import pytest

from app.planning.tone import linear_of_srgb
from app.targets.drawing import BLACK_RGB, RED_RGB, cell_colours_rgb
from app.vision.homography import PLATE_DOTS_U, apply_homographies
from app.vision.inks import BASE
from app.vision.kernels.inkwell import RED
from app.vision.measurement import PlateFits, SizedPatches, fit_patches
from app.vision.patches import Pyramid, take_patches
from app.vision.template import PatchGrid, plate_design, plate_template
from tests.vision.scenes import NOISELESS, Shot, before_wall, plate_at, plates_in_rows, sensor_shots, true_homographies

BLUR_PX = 0.85  # of the lens, a pixel's box and bilinear sampling
SIZES_PX_PER_U = (3.0, 8.0, 4.0, 7.0)


@pytest.fixture(scope="module")
def clean(codes: np.ndarray) -> Shot:
    return sensor_shots(before_wall(plates_in_rows(codes, (6, 4), 4.0, seed=4, slant_deg=40.0)), NOISELESS, [1])[0]


@pytest.fixture(scope="module")
def mixed(codes: np.ndarray) -> Shot:
    """Small and large plates side by side."""
    plates = [
        plate_at((80.0 + 160.0 * index, 240.0), size, int(codes[index]), (0.4, -0.3, index))
        for index, size in enumerate(SIZES_PX_PER_U)
    ]
    return sensor_shots(before_wall(plates), NOISELESS, [1])[0]


def fitted(shot: Shot, homographies: np.ndarray, blur_px: float = BLUR_PX) -> PlateFits:
    return SizedPatches.of(Pyramid.of(shot.bgr, 3), homographies).fit(blur_px)


def test_amplitudes_are_the_inks_light_above_the_plates_black(clean: Shot) -> None:
    fits = fitted(clean, true_homographies(clean))
    black = linear_of_srgb(BLACK_RGB)[::-1]
    red = (linear_of_srgb(RED_RGB)[::-1] - black)[RED]
    for plate, target in enumerate(clean.truth):
        inks = linear_of_srgb(cell_colours_rgb(target.code))[:, ::-1] - black
        level = fits.amplitudes[plate, BASE, RED].mean()
        # Whitest minus blackest is 1.6 of red; blur in steps, and what the model does not know, take a few per cent.
        np.testing.assert_allclose(fits.amplitudes[plate] / level, inks / red, atol=0.08)
        np.testing.assert_allclose(fits.background[plate] / level, black / red, atol=0.03)


def test_the_model_explains_a_plate_and_nothing_else(clean: Shot) -> None:
    fits = fitted(clean, true_homographies(clean))
    assert fits.explained().min() > 0.97
    beside = np.array([[1.0, 0.0, 53.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) @ true_homographies(clean)[:20]
    assert np.median(fitted(clean, beside).explained()) < 0.7


def test_a_flat_patch_is_not_explained() -> None:
    wall = np.full((480, 640, 3), 130, dtype=np.uint8)
    somewhere = np.array([[[4.0, 0.0, 320.0], [0.0, 4.0, 240.0], [0.0, 0.0, 1.0]]])
    assert SizedPatches.of(Pyramid.of(wall, 1), somewhere).fit(BLUR_PX).explained().tolist() == [0.0]


def test_slopes_over_amplitudes_are_how_far_the_dots_stand_off(clean: Shot) -> None:
    shift_u = np.array([0.08, -0.05])
    moved = true_homographies(clean) @ np.array([[1.0, 0.0, shift_u[0]], [0.0, 1.0, shift_u[1]], [0.0, 0.0, 1.0]])
    fits = fitted(clean, moved)
    red, slopes = fits.amplitudes[:, BASE, RED], fits.slopes[:, BASE][..., RED]
    # The patch was taken too far along the shift: the dots stand back by it, but for its square.
    np.testing.assert_allclose(slopes / red[..., None], np.broadcast_to(-shift_u, slopes.shape), atol=0.022)


def test_plates_of_all_sizes_are_fitted_in_their_order(mixed: Shot) -> None:
    homographies = true_homographies(mixed)
    together = fitted(mixed, homographies)
    large = together.px_per_u > PatchGrid.FINE.px_per_u_max
    assert large.any() and not large.all()
    np.testing.assert_array_equal(together.image_from_plate, homographies)
    for plate in range(len(homographies)):
        alone = fitted(mixed, homographies[[plate]])
        for field in fields(PlateFits):
            expected = getattr(alone, field.name)[0]
            allowed = 1e-4 * np.abs(expected).max()  # samples are float32
            np.testing.assert_allclose(getattr(together, field.name)[plate], expected, atol=allowed, err_msg=field.name)


def test_dots_are_found_at_every_size(mixed: Shot) -> None:
    homographies = true_homographies(mixed)
    fits = fitted(mixed, homographies)
    offset_u = fits.slopes[:, BASE][..., RED] / fits.amplitudes[:, BASE, RED, None]
    dots_px = apply_homographies(homographies, PLATE_DOTS_U[BASE] + offset_u)
    truth_px = np.stack([target.dots_px[BASE] for target in mixed.truth])
    away_u = np.linalg.norm(dots_px - truth_px, axis=2) / np.array(SIZES_PX_PER_U)[:, None]
    assert away_u.max() < 0.02  # a fiftieth of a radius


def test_residuals_are_what_the_model_leaves(clean: Shot) -> None:
    """Found from the normal equations alone; here the long way."""
    homographies = true_homographies(clean)[:3]
    patches = take_patches(Pyramid.of(clean.bgr, 1), homographies, PatchGrid.FINE)
    blur_px = np.array([0.6, 0.85, 1.4])
    fits = fit_patches(patches, blur_px)
    for plate, level in enumerate(patches.levels(blur_px).tolist()):
        template, design = plate_template(PatchGrid.FINE, level), plate_design(PatchGrid.FINE, level)
        samples = patches.samples[plate].astype(np.float64)
        coefficients = samples @ design @ template.cofactors
        residual = samples - coefficients @ design.T
        assert fits.residual_rms[plate] == pytest.approx(np.sqrt((residual**2).mean()), rel=0.01)
        spread = np.sqrt(((samples - samples.mean(axis=1, keepdims=True)) ** 2).mean())
        assert fits.spread_rms[plate] == pytest.approx(spread, rel=1e-3)
        assert fits.explained()[plate] == pytest.approx(1.0 - (fits.residual_rms[plate] / spread) ** 2, abs=1e-3)
        np.testing.assert_array_equal(fits.offset_cofactors[plate], template.offset_cofactors)


def test_the_right_blur_leaves_least(clean: Shot) -> None:
    homographies = true_homographies(clean)
    left = [np.median(fitted(clean, homographies, blur_px).residual_rms) for blur_px in (0.3, BLUR_PX, 1.6)]
    assert left[1] < 0.7 * min(left[0], left[2])


def test_a_few_plates_are_fitted_under_every_blur(clean: Shot) -> None:
    patches = SizedPatches.of(Pyramid.of(clean.bgr, 1), true_homographies(clean))
    blurs_px = (0.4, 0.9, 1.7)
    some = patches.fit_some(5, blurs_px)
    assert len(some.px_per_u) == 5 * len(blurs_px)
    for index, blur_px in enumerate(blurs_px):
        whole = patches.fit(blur_px)
        chosen = [
            int(np.abs(whole.image_from_plate - one).sum(axis=(1, 2)).argmin()) for one in some.image_from_plate[:5]
        ]
        assert len(set(chosen)) == 5
        part = some.select(np.arange(5 * index, 5 * index + 5))
        np.testing.assert_allclose(part.amplitudes, whole.amplitudes[chosen], rtol=1e-3, atol=1e-2)


def test_fits_can_be_chosen_and_joined(clean: Shot) -> None:
    fits = fitted(clean, true_homographies(clean))
    rest, first = fits.select(np.arange(1, 24)), fits.select(np.array([0]))
    joined = PlateFits.joined([rest, first])
    order = np.append(np.arange(1, 24), 0)
    for field in fields(PlateFits):
        np.testing.assert_array_equal(getattr(joined, field.name), getattr(fits, field.name)[order])
