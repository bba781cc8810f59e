import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.observations import Detection
from app.planning.imaging import ImagingOptions
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS, BASE_NAMES
from app.vision.detector import detect
from app.vision.dots import Blobs
from app.vision.hidden_dots import MISSING, HiddenDotOptions, complete_groups
from app.vision.homography import apply_homographies, homography_jacobians
from app.vision.proposals import BASE_U
from tests.vision.scenes import U_M, Shot, before_wall, facing_panel, found, photograph, plate_at, plates_in_rows
from tests.vision.views import NEARLY_AFFINE, image_from_plate

BROWN_RGB = (120, 110, 90)
ROLES = range(len(BASE_NAMES))
WHOLE = 3
E = BASE_NAMES.index("E")


@given(elements=st.lists(st.floats(-10.0, 10.0), min_size=6, max_size=6))
def test_four_dots_give_the_fifth_in_every_affine_view(elements: list[float]) -> None:
    image = BASE_U @ np.reshape(elements[:4], (2, 2)) + elements[4:]
    for missing in MISSING:
        np.testing.assert_allclose(np.array(missing.relation) @ image, 0.0, atol=1e-9)
        np.testing.assert_allclose(np.array(missing.prediction) @ image, image[missing.role], atol=1e-9)
        # Neither may look at the dot that is not there.
        assert missing.relation[missing.role] == 0 and missing.prediction[missing.role] == 0


def base_blobs(image: np.ndarray) -> Blobs:
    axes_px = np.linalg.svd(homography_jacobians(image[None], BASE_U)[0], compute_uv=False)
    return Blobs(apply_homographies(image[None], BASE_U)[0], axes_px)


@settings(max_examples=100)
@given(**NEARLY_AFFINE, role=st.sampled_from(ROLES), order=st.permutations(range(4)))
def test_the_hidden_dot_is_made_up_where_it_is(
    slant_rad: float, towards_rad: float, roll_rad: float, distance_u: float, role: int, order: list[int]
) -> None:
    blobs = base_blobs(image_from_plate(slant_rad, towards_rad, roll_rad, distance_u))
    seen = np.delete(np.arange(5), role)[order]
    four = Blobs(blobs.centres_px[seen], blobs.semi_axes_px[seen])
    completed, groups = complete_groups(four, np.arange(4))
    true_group = np.empty(5, dtype=int)
    true_group[seen] = np.arange(4)
    others = np.delete(np.arange(5), role)
    same = [group for group in groups if group[role] >= 4 and (group[others] == true_group[others]).all()]
    assert len(same) == 1
    away_px = np.linalg.norm(completed.centres_px[same[0][role]] - blobs.centres_px[role])
    assert away_px < blobs.semi_axes_px[role, 0]
    np.testing.assert_array_equal(completed.centres_px[:4], four.centres_px)


def test_four_dots_of_no_plate_are_left_alone() -> None:
    blobs = base_blobs(image_from_plate(0.3, 0.0, 0.0, 300.0))
    centres_px = blobs.centres_px[:4].copy()
    centres_px[2] -= 4.0 * blobs.semi_axes_px[2, 0]  # C, towards the others
    assert complete_groups(Blobs(centres_px, blobs.semi_axes_px[:4]), np.arange(4))[1].shape == (0, 5)


def test_fewer_than_four_and_those_that_are_taken_are_left_alone() -> None:
    blobs = base_blobs(image_from_plate(0.3, 0.0, 0.0, 300.0))
    assert len(complete_groups(blobs, np.array([0, 1, 2, 3]))[1])
    for free in ([], [0, 1, 2]):
        completed, groups = complete_groups(blobs, np.array(free, dtype=int))
        assert completed is blobs and groups.shape == (0, 5)
    assert not len(complete_groups(blobs, np.arange(4), HiddenDotOptions(blobs_max=3))[1])


@pytest.fixture(scope="module")
def half_hidden(codes: np.ndarray) -> Shot:
    """Eight plates; something brown stands before A of the first, B of the second ... E of the fifth."""
    plates = [
        plate_at((100 + 145 * (index % 4), 120 + 240 * (index // 4)), 5.0, int(code), (0.2, 0.3 - 0.1 * index, index))
        for index, code in enumerate(codes[: len(ROLES) + WHOLE])
    ]
    things = []
    for role in ROLES:
        dots_m = plates[role].dots_m()
        outwards = dots_m[BASE_CELLS[role]] - dots_m.mean(axis=0)
        # From beyond a corner; before E, which stands inside, there is no beyond.
        reach_u, size_u = (1.2, 5.5) if role < E else (0.0, 4.0)
        place_m = dots_m[BASE_CELLS[role]] + reach_u * U_M * outwards / np.linalg.norm(outwards)
        things.append(facing_panel(0.9 * place_m, (0.9 * size_u * U_M, 0.9 * size_u * U_M), BROWN_RGB))
    return photograph(before_wall(plates, *things), ImagingOptions())


@pytest.fixture(scope="module")
def seen(half_hidden: Shot, family: CodeFamily) -> Detection:
    return detect(half_hidden.bgr, family)


def test_whole_plates_beside_them_are_read(half_hidden: Shot, seen: Detection) -> None:
    assert len(half_hidden.whole_codes()) == WHOLE and half_hidden.whole_codes() <= set(found(seen))


@pytest.mark.parametrize("role", range(E))
def test_a_target_is_read_though_a_corner_dot_is_hidden(half_hidden: Shot, seen: Detection, role: int) -> None:
    target, cell = half_hidden.truth[role], BASE_CELLS[role]
    observation = found(seen)[target.code]
    assert target.hidden[cell] and not observation.measured[cell]
    others = [base for base in BASE_CELLS if base != cell]
    assert observation.measured[others].all()
    # A twentieth of a radius: nothing of what stands before the plate was measured.
    assert np.abs(observation.centres_px[others] - target.dots_px[others]).max() < 0.25


def test_without_e_four_dots_fit_in_four_ways_and_none_is_misread(half_hidden: Shot, seen: Detection) -> None:
    assert set(found(seen)) <= {target.code for target in half_hidden.truth}


def test_plates_that_all_lack_a_dot_do_not_take_each_others(codes: np.ndarray, family: CodeFamily) -> None:
    """Five dots of several plates may lie like one plate's."""
    plates = plates_in_rows(codes, (4, 3), 5.0, seed=1, slant_deg=30.0)
    corners_m = [plate.dots_m()[0] + 0.28 * (plate.dots_m()[0] - plate.dots_m().mean(axis=0)) for plate in plates]
    things = [facing_panel(0.9 * corner_m, (5.0 * U_M, 5.0 * U_M), BROWN_RGB) for corner_m in corners_m]
    shot = photograph(before_wall(plates, *things), ImagingOptions())
    assert all(target.hidden[0] for target in shot.truth) and len(shot.truth) == 12
    assert set(found(detect(shot.bgr, family))) == {target.code for target in shot.truth}
