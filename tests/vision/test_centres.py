from dataclasses import replace

import numpy as np
import pytest

from app.planning.imaging import expose
from app.planning.painting import paint
from app.planning.scene import Scene
from app.targets.digits import digits_of_code
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.centres import (
    CentreOptions,
    DotCentres,
    locate_dots,
    refine_homographies,
)
from app.vision.detector import DetectorOptions, detect
from app.vision.homography import (
    PLATE_DOTS_U,
    apply_homographies,
    area_scales,
    fit_homographies,
    homography_jacobians,
    local_px_per_u,
)
from app.vision.inks import read_inks
from app.vision.kernels.misfits import HOMOGRAPHY_PARAMETERS
from app.vision.measurement import PlateFits, SizedPatches
from app.vision.patches import Pyramid
from app.vision.settling import SettlingOptions, settled_covariances
from app.vision.template import blurred_disc
from tests.vision.scenes import (
    AT_ORIGIN,
    NOISELESS,
    SMALL_CAMERA,
    Shot,
    before_wall,
    found,
    measured_errors,
    plate_at,
    plates_in_rows,
    sensor_shots,
    true_homographies,
)
from tests.vision.views import image_from_plate

ELECTRONS, READ_NOISE = 200.0, 3.0
NOISY = replace(NOISELESS, full_well_electrons=ELECTRONS, read_noise_electrons=READ_NOISE)
SEEDS = (1, 2)
PX_PER_U = 4.0
REACH_PX = 9  # of the window about a dot
PLATES = 40
BASE = list(BASE_CELLS)
NOTHING_UNSEEN = DetectorOptions(
    centres=CentreOptions(unseen_factor=1.0), settling=SettlingOptions(unseen_factor=1.0, floor_px=0.01)
)


def errors_of(
    scene: Scene, family: CodeFamily, options: DetectorOptions = NOTHING_UNSEEN
) -> tuple[np.ndarray, np.ndarray]:
    """Errors and covariances of all measured dots in photographs that differ by their noise alone."""
    pairs = []
    for shot in sensor_shots(scene, NOISY, SEEDS):
        detection = detect(shot.bgr, family, options)
        assert set(found(detection)) == shot.whole_codes()
        pairs.append(measured_errors(detection, shot))
    return np.concatenate([errors for errors, _ in pairs]), np.concatenate([covariances for _, covariances in pairs])


@pytest.fixture(scope="module")
def frontal(codes: np.ndarray) -> Scene:
    return before_wall(plates_in_rows(codes, (6, 4), PX_PER_U, seed=1, slant_deg=0.0))


def least_variance_px2(scene: Scene, shot: Shot) -> float:
    """Mean Cramer-Rao bound of the coloured dots' coordinates, for discs in shot and read noise."""
    light = expose(paint(scene, SMALL_CAMERA, AT_ORIGIN), NOISY).astype(np.float64)
    places_px = np.concatenate(
        [t.dots_px[[*BASE, *np.array(DIGIT_CELLS)[digits_of_code(t.code) > 0]]] for t in shot.truth]
    )
    nearest = np.rint(places_px).astype(int)
    step = np.arange(-REACH_PX, REACH_PX + 1)
    columns, rows = nearest[:, :1, None] + step, nearest[:, 1:, None] + step[:, None]
    windows = light[rows, columns]  # (N, 19, 19, 3)
    dx, dy = columns - places_px[:, :1, None], rows - places_px[:, 1:, None]
    away_px = np.hypot(dx, dy)
    blur_px = np.hypot(NOISY.lens_sigma_px, np.sqrt(1 / 12))  # and a pixel's box
    disc, by_radius = blurred_disc(away_px / PX_PER_U, blur_px / PX_PER_U)
    gradient = by_radius / PX_PER_U * dx / np.maximum(away_px, 1e-9)
    black = np.percentile(windows, 5, axis=(1, 2))[:, None, None]
    amplitude = windows[:, REACH_PX, REACH_PX][:, None, None] - black
    noise = (black + disc[..., None] * amplitude) / ELECTRONS + (READ_NOISE / ELECTRONS) ** 2
    information = ((gradient[..., None] * amplitude) ** 2 / noise).sum(axis=(1, 2, 3))
    return float((1.0 / information).mean())


def test_centres_are_nearly_as_good_as_the_noise_allows(frontal: Scene, family: CodeFamily) -> None:
    errors_px, _ = errors_of(frontal, family)
    bound_px = np.sqrt(least_variance_px2(frontal, sensor_shots(frontal, NOISELESS, [1])[0]))
    rms_px = np.sqrt((errors_px**2).mean())
    # Samples stand 1.6 px apart, and the dots' inks, gradients and neighbours are unknowns beside their places.
    assert bound_px < rms_px < 1.8 * bound_px


def test_centres_are_unbiased(frontal: Scene, family: CodeFamily) -> None:
    for shot in sensor_shots(frontal, NOISY, SEEDS[:1]):
        detection = detect(shot.bgr, family)
        errors_px, _ = measured_errors(detection, shot)
        standard_error_px = np.sqrt((errors_px**2).mean() / len(errors_px))
        assert np.abs(errors_px.mean(axis=0)).max() < 4 * standard_error_px
        outwards = []
        for target in detection.targets:
            true_px = shot.dots_px(target.code)
            away_px = true_px[BASE[:4]] - true_px.mean(axis=0)
            error_px = (target.centres_px - true_px)[BASE[:4]]
            outwards.extend(((error_px * away_px).sum(axis=1) / np.linalg.norm(away_px, axis=1)).tolist())
        assert abs(np.mean(outwards)) < 4 * np.std(outwards) / np.sqrt(len(outwards))  # plates are not too large


def test_covariances_are_those_of_the_errors(codes: np.ndarray, family: CodeFamily) -> None:
    """Where all noise is independent, nothing is unseen: then normalised squared errors have mean 1."""
    squares = []
    for px_per_u, grid in ((3.0, (7, 5)), (4.0, (6, 4))):
        scene = before_wall(plates_in_rows(codes, grid, px_per_u, seed=7, slant_deg=45.0))
        errors_px, covariances_px2 = errors_of(scene, family)
        squares.append(np.einsum("ni,nij,nj->n", errors_px, np.linalg.inv(covariances_px2), errors_px) / 2)
    normalised = np.concatenate(squares)
    # Four standard errors of a mean over two coordinates each, and 5 % for blur that is known in steps.
    assert abs(normalised.mean() - 1.0) < 4 / np.sqrt(len(normalised)) + 0.05


def test_covariances_of_a_compressed_photograph_are_on_the_safe_side(plates_shot: Shot, family: CodeFamily) -> None:
    errors_px, covariances_px2 = measured_errors(detect(plates_shot.bgr, family), plates_shot)
    normalised = np.einsum("ni,nij,nj->n", errors_px, np.linalg.inv(covariances_px2), errors_px) / 2
    allowance = CentreOptions().unseen_factor
    assert allowance**-2 < normalised.mean() < 1.0 + 4 / np.sqrt(len(normalised))


def ellipse_offsets_px(homography: np.ndarray) -> np.ndarray:
    """From the images of the dots' centres to the centres of their images, shape (16, 2)."""
    angle = np.arange(720) * np.pi / 360
    rims_u = PLATE_DOTS_U[:, None] + np.stack([np.cos(angle), np.sin(angle)], axis=1)
    x, y = np.moveaxis(apply_homographies(homography[None], rims_u.reshape(-1, 2)).reshape(16, 720, 2), 2, 0)
    cross = x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y
    moments = np.stack([(one + np.roll(one, -1, 1)) * cross for one in (x, y)], axis=-1).sum(axis=1)
    return moments / (3 * cross.sum(axis=1))[:, None] - apply_homographies(homography[None], PLATE_DOTS_U)[0]


@pytest.mark.parametrize(("px_per_u", "allowed_px"), [(8.0, 0.03), (20.0, 0.12)])  # 0.4 and 0.6 % of a radius
def test_a_circles_centre_is_not_its_ellipses_centre(family: CodeFamily, px_per_u: float, allowed_px: float) -> None:
    """A large plate near the camera at 60 degrees, no noise: what a centroid would err by is gone."""
    slant_rad = np.radians(60.0)
    plate = plate_at((330.0, 250.0), px_per_u, 389, (0.8 * slant_rad, 0.6 * slant_rad, 0.5))
    shot = sensor_shots(before_wall([plate]), NOISELESS, [1])[0]
    target = found(detect(shot.bgr, family))[389]
    offsets_px = ellipse_offsets_px(true_homographies(shot)[0])[target.measured]
    errors_px = (target.centres_px - shot.dots_px(389))[target.measured]
    assert np.sqrt((errors_px**2).mean()) < allowed_px
    # The share of the offset that is left.
    assert abs((errors_px * offsets_px).sum() / (offsets_px**2).sum()) < 0.25
    assert px_per_u < 10 or np.linalg.norm(offsets_px, axis=1).max() > 4 * allowed_px  # there was something to remove


def fits_of(shot: Shot) -> PlateFits:
    return SizedPatches.of(Pyramid.of(shot.bgr, 3), true_homographies(shot)).fit(0.85)


def test_one_step_takes_dots_to_their_places(frontal: Scene) -> None:
    """Patches taken 0.14 u off: what is left is of second order."""
    shot = sensor_shots(frontal, NOISELESS, [1])[0]
    shifted = true_homographies(shot) @ np.array([[1.0, 0.0, 0.1], [0.0, 1.0, -0.1], [0.0, 0.0, 1.0]])
    fits = SizedPatches.of(Pyramid.of(shot.bgr, 1), shifted).fit(0.85)
    dots = locate_dots(fits, read_inks(fits.amplitudes), (640, 480))
    errors_px = (dots.centres_px - np.stack([target.dots_px for target in shot.truth]))[dots.measured]
    assert np.sqrt((errors_px**2).mean()) < 0.01 * PX_PER_U
    shift_px = np.einsum("pij,j->pi", homography_jacobians(shifted, np.zeros((1, 2)))[:, 0], [0.1, -0.1])
    along = np.repeat(shift_px, dots.measured.sum(axis=1), axis=0)
    assert abs((errors_px * along).sum() / (along**2).sum()) < 0.05  # the share of the way that is left


def test_dots_in_black_and_dots_outside_are_not_measured(codes: np.ndarray) -> None:
    places = ((8.0, 200.0), (320.0, 470.0), (200.0, 5.0), (400.0, 240.0))
    plates = [plate_at(place, 5.0, int(code), (0.2, 0.1, 0.3)) for place, code in zip(places, codes[:4], strict=True)]
    shot = sensor_shots(before_wall(plates), NOISELESS, [1])[0]
    fits = fits_of(shot)
    dots = locate_dots(fits, read_inks(fits.amplitudes), (640, 480))
    for plate, target in enumerate(shot.truth):
        assert not dots.inside[plate, target.hidden].any()
        black = [cell for cell, d in zip(DIGIT_CELLS, digits_of_code(target.code), strict=True) if d == 0]
        assert not dots.measured[plate, black].any()
        inked = np.delete(np.arange(16), black)
        # The frame ends half a pixel beyond the outermost pixels' centres; a dot there has lost some of its light.
        clear = ((target.dots_px > 8.0) & (target.dots_px < [631.0, 471.0])).all(axis=1)
        assert dots.measured[plate, inked[clear[inked]]].all() and clear.any()
    assert not (dots.measured & ~dots.inside).any()


@pytest.fixture(scope="module")
def scattered() -> tuple[DotCentres, np.ndarray]:
    """Dots of forty plates that scatter by three times what their covariances say."""
    rng = np.random.default_rng(1)
    homographies = np.repeat(image_from_plate(0.5, 1.0, 0.3, 250.0)[None], PLATES, axis=0)
    px_by_u = homography_jacobians(homographies, PLATE_DOTS_U)
    covariances_u2 = np.broadcast_to(0.02**2 * np.eye(2), (PLATES, 16, 2, 2))
    error_px = 3.0 * np.einsum("pdij,pdj->pdi", px_by_u, 0.02 * rng.normal(size=(PLATES, 16, 2)))
    centres_px = apply_homographies(homographies, PLATE_DOTS_U) + error_px
    seen = np.ones((PLATES, 16), dtype=bool)
    return DotCentres(centres_px, covariances_u2, px_by_u, seen, seen), homographies


def refined(dots: DotCentres, homographies: np.ndarray) -> np.ndarray:
    empty = np.zeros((len(homographies), 0))
    return refine_homographies(PlateFits(homographies, local_px_per_u(homographies), *[empty] * 6), dots)


OPTIONS = CentreOptions(covariance_floor_px=0.0, covariance_floor_u=0.0)


def calibrated_covariances(
    dots: DotCentres, homographies: np.ndarray, trusted: np.ndarray, options: CentreOptions
) -> np.ndarray:
    """Of plates none of which is large enough to be settled."""
    nothing = np.zeros(len(trusted), dtype=bool)
    return settled_covariances(dots, homographies, trusted, nothing, (options, SettlingOptions()))


def in_pixels(dots: DotCentres) -> np.ndarray:
    """Covariances as the fits have them, shape (P, 16, 2, 2), px^2."""
    return dots.px_by_u @ dots.covariances_u2 @ dots.px_by_u.swapaxes(2, 3)


def test_covariances_grow_to_what_the_dots_scatter_by(scattered: tuple[DotCentres, np.ndarray]) -> None:
    dots, homographies = scattered
    everyone = np.ones(PLATES, dtype=bool)
    through_dots = refined(dots, homographies)
    grown = calibrated_covariances(dots, through_dots, everyone, OPTIONS)
    factor = np.median(grown / in_pixels(dots)) / OPTIONS.unseen_factor
    # The median of chi squared over 24 redundancies each; the prior pulls by 20 of 980 towards 1.
    assert factor == pytest.approx(9.0, rel=4 * np.sqrt(2 / (PLATES * (32 - HOMOGRAPHY_PARAMETERS))) + 0.05)
    bent = replace(dots, centres_px=dots.centres_px.copy())
    bent.centres_px[:8] += 20.0 * np.random.default_rng(2).normal(size=(8, 16, 2))
    with_bent = calibrated_covariances(bent, refined(bent, homographies), everyone, OPTIONS)
    np.testing.assert_allclose(with_bent, grown, rtol=0.5)  # their mean would be thousands of times as large
    left_out = calibrated_covariances(bent, refined(bent, homographies), np.arange(PLATES) >= 8, OPTIONS)
    np.testing.assert_allclose(left_out, grown, rtol=0.1)


def test_without_trusted_plates_covariances_keep_the_fits_own_noise(scattered: tuple[DotCentres, np.ndarray]) -> None:
    dots, homographies = scattered
    kept = calibrated_covariances(dots, homographies, np.zeros(PLATES, dtype=bool), OPTIONS)
    np.testing.assert_allclose(kept, OPTIONS.unseen_factor * in_pixels(dots))


def test_floors_keep_covariances_positive(scattered: tuple[DotCentres, np.ndarray]) -> None:
    dots, homographies = scattered
    exact = replace(dots, covariances_u2=np.zeros_like(dots.covariances_u2))
    options, nobody = CentreOptions(), np.zeros(PLATES, dtype=bool)
    least_px2 = np.linalg.eigvalsh(calibrated_covariances(exact, homographies, nobody, options)).min()
    assert least_px2 >= options.unseen_factor * options.covariance_floor_px**2


def test_homographies_follow_the_measured_dots(scattered: tuple[DotCentres, np.ndarray]) -> None:
    dots, homographies = scattered
    shifted = replace(dots, centres_px=apply_homographies(homographies, PLATE_DOTS_U) + np.array([3.0, -2.0]))
    half = replace(shifted, measured=np.broadcast_to(np.arange(16) % 2 == 0, (PLATES, 16)))
    np.testing.assert_allclose(
        apply_homographies(refined(half, homographies), PLATE_DOTS_U), shifted.centres_px, atol=1e-3
    )
    few = replace(shifted, measured=np.broadcast_to(np.arange(16) < 4, (PLATES, 16)))
    np.testing.assert_array_equal(refined(few, homographies), homographies)
    # A row of four and E: the plate would collapse on them.
    in_line = np.where(np.isin(np.arange(16), [0, 1, 2, 3, 5])[:, None], shifted.centres_px[:, :1], shifted.centres_px)
    collapsed = replace(
        shifted, centres_px=in_line, measured=np.broadcast_to(in_line[0, :, 0] == in_line[0, 0, 0], (PLATES, 16))
    )
    np.testing.assert_array_equal(refined(collapsed, homographies), homographies)


def test_homographies_are_weighted_by_the_precision_of_the_dots_in_pixels(
    scattered: tuple[DotCentres, np.ndarray],
) -> None:
    dots, homographies = scattered
    factors = np.random.default_rng(5).uniform(1.0, 30.0, (PLATES, 16, 1, 1))
    dots = replace(
        dots, covariances_u2=dots.covariances_u2 * factors, measured=np.arange(16) % 5 + np.zeros((PLATES, 1)) > 0
    )
    variances_px2 = factors[..., 0, 0] * area_scales(dots.px_by_u) ** 2
    weights = np.where(dots.measured, variances_px2.min(axis=1, keepdims=True) / variances_px2, 0.0)
    expected = fit_homographies(PLATE_DOTS_U, dots.centres_px, weights)
    np.testing.assert_allclose(refined(dots, homographies), expected, rtol=1e-9, atol=1e-12)


def test_some_plates_can_be_chosen(scattered: tuple[DotCentres, np.ndarray]) -> None:
    dots, _ = scattered
    chosen = dots.select(np.array([3, 1]))
    np.testing.assert_array_equal(chosen.centres_px, dots.centres_px[[3, 1]])
    np.testing.assert_array_equal(chosen.covariances_u2, dots.covariances_u2[[3, 1]])
