import numpy as np

from app.targets.family import CodeFamily
from app.targets.layout import DIGIT_CELLS
from app.vision.covered_sides import covered_sides
from app.vision.detector import DetectorOptions, detect
from app.vision.homography import PLATE_DOTS_U
from app.vision.kernels.inkwell import RED
from app.vision.measurement import fit_patches
from app.vision.parts_in_sight import BASE, PartOptions, fit_in_sight, third_red
from app.vision.patches import Patches, Pyramid, take_patches
from app.vision.template import PatchGrid
from app.vision.visible_fit import VisibleFits, fit_visible
from tests.vision.scenes import Shot, found, true_homographies
from tests.vision.test_hidden_sides import BROWN_RGB, QUARTER_U, WHITE_RGB, shot_behind_boards

BLUR_PX = 0.8
TENTH_U = 1.3
FINE = PatchGrid.FINE


def patches_of(shot: Shot) -> Patches:
    return take_patches(Pyramid.of(shot.bgr, 1), true_homographies(shot), FINE)


def test_a_plate_seen_whole_is_fitted_as_ever(plates_shot: Shot) -> None:
    patches = patches_of(plates_shot)
    whole = fit_patches(patches, np.full(len(patches.samples), BLUR_PX))
    visible = fit_visible(patches, BLUR_PX, np.ones((len(patches.samples), FINE.value**2), dtype=bool))
    assert not visible.hidden.any() and not visible.cut.any()
    np.testing.assert_allclose(visible.fits.amplitudes, whole.amplitudes, atol=0.2)  # of 255: the ridge on dots
    np.testing.assert_allclose(visible.fits.explained(), whole.explained(), atol=1e-3)
    assert len(VisibleFits.none().fits.px_per_u) == 0


def test_nothing_covers_plates_in_plain_view(plates_shot: Shot) -> None:
    homographies = true_homographies(plates_shot)
    fits = fit_patches(patches_of(plates_shot), np.full(len(homographies), BLUR_PX))
    assert not covered_sides(plates_shot.bgr, third_red(fits.amplitudes), homographies).covered().size


def test_a_board_is_found_from_its_side_and_as_deep_as_it_is(codes: np.ndarray) -> None:
    shot = shot_behind_boards(codes, QUARTER_U, BROWN_RGB, 3)
    homographies = true_homographies(shot)
    fits = fit_patches(patches_of(shot), np.full(len(homographies), BLUR_PX))
    sides = covered_sides(shot.bgr, third_red(fits.amplitudes), homographies)
    order = [[plate.code for plate in shot.truth].index(code) for code in codes[: len(shot.truth)]]
    depths_u = np.median(sides.depths_u[order], axis=2)
    for plate, depth_u in enumerate(depths_u):
        assert QUARTER_U <= depth_u[plate % 4] < QUARTER_U + 1.0
        assert (np.delete(depth_u, plate % 4) == 0.0).all()
    assert len(sides.covered()) == len(homographies)
    parts = fit_in_sight(Pyramid.of(shot.bgr, 1), fits, [homographies], BLUR_PX)
    assert (parts.hidden.sum(axis=1) == 4).all() and (parts.hidden[:, BASE].sum(axis=1) == 2).all()
    assert (parts.fits.explained() > 0.95).all()
    # No light is told where nothing is seen, and as much as ever beside it.
    assert (parts.fits.amplitudes[parts.hidden] == 0.0).all()
    seen_red = parts.fits.amplitudes[:, BASE, RED][~parts.hidden[:, BASE]]
    assert seen_red.min() > 0.5 * np.median(seen_red)


def test_a_side_that_must_be_covered_is_the_one_that_is(codes: np.ndarray) -> None:
    shot = shot_behind_boards(codes, QUARTER_U, BROWN_RGB, 3)
    homographies = true_homographies(shot)
    red = third_red(fit_patches(patches_of(shot), np.full(len(homographies), BLUR_PX)).amplitudes)
    side = covered_sides(shot.bgr, red, homographies).depths_u.max(axis=2).argmax(axis=1)
    asked = [covered_sides(shot.bgr, red, homographies, must=(side + turn) % 4).covered() for turn in range(4)]
    np.testing.assert_array_equal(asked[0], np.arange(len(homographies)))
    assert not any(len(plates) for plates in asked[1:])


def test_samples_in_sight_are_those_beyond_the_board(codes: np.ndarray) -> None:
    shot = shot_behind_boards(codes, QUARTER_U, WHITE_RGB, 8)
    homographies = true_homographies(shot)
    fits = fit_patches(patches_of(shot), np.full(len(homographies), BLUR_PX))
    seen = covered_sides(shot.bgr, third_red(fits.amplitudes), homographies).seen(PLATE_DOTS_U)
    assert (seen.sum(axis=1) == 12).all() and (seen[:, DIGIT_CELLS].sum(axis=1) == 9).all()


def test_boards_over_a_tenth_cost_no_plate(codes: np.ndarray, family: CodeFamily) -> None:
    shot = shot_behind_boards(codes, TENTH_U, WHITE_RGB, 8)
    assert set(found(detect(shot.bgr, family))) == {target.code for target in shot.truth}
    without = DetectorOptions(parts=PartOptions(plates_max=0))
    assert len(found(detect(shot.bgr, family, without))) < len(shot.truth) - 2
