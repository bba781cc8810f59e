import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.pose import Pose
from app.planning.imaging import ImagingOptions
from app.planning.scene import Panel
from app.planning.surfaces import PlainSurface
from app.targets.digits import digits_of_codes
from app.targets.drawing import cell_colours_rgb
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS
from app.vision.detector import detect
from app.vision.dots import Blobs
from app.vision.hidden_sides import HIDDEN_CORNERS, SEEN_CORNERS, E, HiddenSideOptions, complete_sides
from app.vision.homography import apply_homographies, homography_jacobians
from app.vision.proposals import BASE_U
from tests.vision.scenes import (
    U_M,
    Shot,
    before_wall,
    found,
    measured_errors,
    photograph,
    plate_at,
    plates_in_rows,
    wrong_plate,
)
from tests.vision.views import NEARLY_AFFINE, image_from_plate

COLUMNS, ROWS = 4, 3
BROWN_RGB, WHITE_RGB, BLACK_RGB = (120, 110, 90), (238, 238, 232), (24, 24, 26)
QUARTER_U = 3.25
# From the target frame to one whose top is the plate's top, right, bottom, left side.
SIDES_RAD = (0.0, -np.pi / 2, np.pi, np.pi / 2)


def board(plate_pose: Pose, side: int, rgb: tuple[int, int, int], depth_u: float) -> Panel:
    """Something flat just before a plate, from a side inwards and well beyond the plate."""
    turn = SIDES_RAD[side]
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    high_u = depth_u + 1.0
    middle_m = U_M * (rotation @ np.array([0.0, 6.5 - depth_u + high_u / 2, 0.2]))
    pose = Pose(plate_pose.rotation @ rotation, plate_pose.apply(middle_m))
    return Panel(pose, 15.0 * U_M, high_u * U_M, PlainSurface(rgb))


def shot_behind_boards(
    codes: np.ndarray, depth_u: float, rgb: tuple[int, int, int], seed: int, px_per_u: float = 5.0
) -> Shot:
    """Plates at random slants and rolls, each with a board over one side, the sides in turn."""
    plates = plates_in_rows(codes, (COLUMNS, ROWS), px_per_u, seed=seed, slant_deg=40.0)
    boards = [board(p.site_from_target, i % 4, rgb, depth_u) for i, p in enumerate(plates)]
    return photograph(before_wall(plates, *boards), ImagingOptions(), seed=seed)


@settings(max_examples=100)
@given(**NEARLY_AFFINE, side=st.integers(0, 3), order=st.permutations(range(3)))
def test_the_hidden_corners_are_made_up_where_they_are(
    slant_rad: float, towards_rad: float, roll_rad: float, distance_u: float, side: int, order: list[int]
) -> None:
    image = image_from_plate(slant_rad, towards_rad, roll_rad, distance_u)
    base_px = apply_homographies(image[None], BASE_U)[0]
    axes_px = np.linalg.svd(homography_jacobians(image[None], BASE_U)[0], compute_uv=False)
    seen = np.array([E, *SEEN_CORNERS[side]])[order]
    completed, groups = complete_sides(Blobs(base_px[seen], axes_px[seen]), np.arange(3))
    hidden = HIDDEN_CORNERS[side]
    true_group = np.full(5, -1)
    true_group[seen] = np.arange(3)
    same = [group for group in groups if (group[hidden] > 2).all() and (group[seen] == true_group[seen]).all()]
    assert len(same) == 1
    away_px = np.linalg.norm(completed.centres_px[same[0][hidden]] - base_px[hidden], axis=1)
    # Perspective: both are predicted over a plate's width, which is at most a tenth of the distance.
    assert (away_px < 1.5 * axes_px[hidden, 0]).all()
    np.testing.assert_array_equal(completed.centres_px[:3], base_px[seen])


def test_dots_of_another_size_and_too_few_are_left_alone() -> None:
    base_px = apply_homographies(image_from_plate(0.3, 0.0, 0.0, 300.0)[None], BASE_U)[0]
    three = Blobs(base_px[[4, 2, 3]], np.full((3, 2), 10.0))  # they have 3.3 px
    assert complete_sides(three, np.arange(3))[1].shape == (0, 5)
    assert complete_sides(three, np.arange(2))[1].shape == (0, 5)
    assert complete_sides(three, np.arange(3), HiddenSideOptions(blobs_max=0))[1].shape == (0, 5)


@pytest.mark.parametrize(("rgb", "seed"), [(BROWN_RGB, 3), (WHITE_RGB, 8)])
def test_plates_with_a_side_hidden_are_read(
    codes: np.ndarray, family: CodeFamily, rgb: tuple[int, int, int], seed: int
) -> None:
    shot = shot_behind_boards(codes, QUARTER_U, rgb, seed)
    detection = detect(shot.bgr, family)
    true = {target.code for target in shot.truth}
    assert set(found(detection)) <= true
    assert len(found(detection)) >= COLUMNS * ROWS - 1
    for target in detection.targets:
        assert target.measured[list(BASE_CELLS)].sum() == 3 and target.corrected == 0 and target.erased == 2
    errors_px, covariances_px2 = measured_errors(detection, shot)
    squares = np.einsum("ni,nij,nj->n", errors_px, np.linalg.inv(covariances_px2), errors_px)
    assert squares.mean() < 2.0 * 2.0  # two per dot are expected; of some hundred dots


@pytest.mark.parametrize("side", range(4))
def test_plates_cut_by_the_photograph_s_border_with_two_base_dots_outside_are_read(
    family: CodeFamily, side: int
) -> None:
    """What lies outside is hidden like what is covered."""
    code, px_per_u = int(family.codes[digits_of_codes(family.codes).min(axis=1) > 0][1]), 8.0  # no digit is black
    plate = plate_at((320.0, 240.0), px_per_u, code, turn_rad=(0.2, -0.1, 0.0))
    shot = photograph(before_wall([plate]), ImagingOptions())
    axis = 1 - side % 2  # of the bottom, the left, the top, the right: rows or columns are cut
    lost_px = shot.dots_px(code)[[BASE_CELLS[corner] for corner in HIDDEN_CORNERS[side]], axis]
    past_px = 1.5 * px_per_u  # beyond the corner dots, before those beside them
    first, last = (round(lost_px.max() + past_px), None) if side in (1, 2) else (0, round(lost_px.min() - past_px))
    bgr = shot.bgr[:, first:last] if axis == 0 else shot.bgr[first:last]
    (target,) = detect(bgr, family).targets
    assert target.code == code and target.measured[list(BASE_CELLS)].sum() == 3
    errors_px = target.centres_px - shot.dots_px(code)
    errors_px[:, axis] += first
    assert np.abs(errors_px[target.measured]).max() < 0.5  # a dot that the border cuts would be off by px


def test_a_side_hidden_by_black_is_not_forgiven(codes: np.ndarray, family: CodeFamily) -> None:
    """What is as black as the plate may as well be a plate of wrong structure."""
    assert not detect(shot_behind_boards(codes, QUARTER_U, BLACK_RGB, 3).bgr, family).targets


def test_plates_printed_without_two_corners_are_refused(codes: np.ndarray, family: CodeFamily) -> None:
    plates = plates_in_rows(codes, (COLUMNS, ROWS), 5.0, seed=3, slant_deg=40.0)
    colours = [cell_colours_rgb(plate.code).copy() for plate in plates]
    for index, cells in enumerate(colours):
        cells[[BASE_CELLS[corner] for corner in HIDDEN_CORNERS[index % 4]]] = BLACK_RGB
    wrong = [wrong_plate(plate, cells) for plate, cells in zip(plates, colours, strict=True)]
    assert not detect(photograph(before_wall(wrong), ImagingOptions()).bgr, family).targets
