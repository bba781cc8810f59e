import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.vision.dots import Blobs
from app.vision.grouping import group_base_dots
from app.vision.homography import PLATE_DOTS_U, apply_homographies, cross, homography_jacobians
from app.vision.proposals import BASE_U
from tests.vision.views import FOCAL_PX, image_from_plate, views

LEAST_FOCAL_PX = 0.5 * FOCAL_PX


def blobs_of_base_dots(homographies: np.ndarray) -> Blobs:
    """Ideal blobs A, B, C, D, E of each plate in turn."""
    jacobians = homography_jacobians(homographies, BASE_U)
    semi_axes_px = np.linalg.svd(jacobians, compute_uv=False)  # of a circle of radius 1 u
    return Blobs(apply_homographies(homographies, BASE_U).reshape(-1, 2), semi_axes_px.reshape(-1, 2))


def shuffled(blobs: Blobs, order: list[int]) -> Blobs:
    return Blobs(blobs.centres_px[order], blobs.semi_axes_px[order])


def in_given_order(groups: np.ndarray, order: list[int]) -> list[list[int]]:
    return np.array(order)[groups].tolist()


def mirrored(blobs: Blobs) -> Blobs:
    return Blobs(blobs.centres_px * [-1.0, 1.0], blobs.semi_axes_px)


@settings(max_examples=300)
@given(homography=views, order=st.permutations(range(5)))
def test_the_base_dots_of_any_view_are_grouped_in_their_roles(homography: np.ndarray, order: list[int]) -> None:
    groups = group_base_dots(shuffled(blobs_of_base_dots(homography[None]), order), LEAST_FOCAL_PX)
    assert in_given_order(groups, order) == [[0, 1, 2, 3, 4]]


@settings(max_examples=150)
@given(homography=views, order=st.permutations(range(5)), seed=st.integers(0, 1000))
def test_a_tenth_of_a_dot_of_noise_does_not_part_them(homography: np.ndarray, order: list[int], seed: int) -> None:
    ideal = blobs_of_base_dots(homography[None])
    noise_px = 0.1 * ideal.semi_axes_px[:, 1:] * np.random.default_rng(seed).uniform(-1.0, 1.0, (5, 2))
    noisy = Blobs(ideal.centres_px + noise_px, ideal.semi_axes_px)
    assert [0, 1, 2, 3, 4] in in_given_order(group_base_dots(shuffled(noisy, order), LEAST_FOCAL_PX), order)


@settings(max_examples=150)
@given(homography=views, order=st.permutations(range(5)))
def test_a_mirrored_plate_never_has_its_roles(homography: np.ndarray, order: list[int]) -> None:
    """Its base dots are those of a plate with B and D exchanged: what tells it apart is its code alone."""
    blobs = mirrored(blobs_of_base_dots(homography[None]))
    groups = in_given_order(group_base_dots(shuffled(blobs, order), LEAST_FOCAL_PX), order)
    assert groups == [[0, 3, 2, 1, 4]]


def test_among_many_blobs_at_random_b_stands_clockwise_of_a() -> None:
    centres_px = np.random.default_rng(3).uniform(0.0, 900.0, (300, 2))
    groups = group_base_dots(Blobs(centres_px, np.full((300, 2), 8.0)), LEAST_FOCAL_PX)
    assert len(groups) > 20
    a, b, c, d, e = np.moveaxis(centres_px[groups], 1, 0)
    assert (cross(c - a, b - d) < 0).all()
    assert (np.einsum("gc,gc->g", e - a, c - e) > 0).all()  # E lies between A and C


def test_plates_side_by_side_are_each_found() -> None:
    """Sheets that touch: another plate's dots are as near as one's own."""
    frontal = image_from_plate(0.0, 0.0, 0.0, 250.0)
    shifts = [
        np.array([[1, 0, 15.0 * column], [0, 1, 15.0 * row], [0, 0, 1]]) for row in range(3) for column in range(3)
    ]
    homographies = np.stack([frontal @ shift for shift in shifts])
    groups = group_base_dots(blobs_of_base_dots(homographies), LEAST_FOCAL_PX).tolist()
    for plate in range(len(shifts)):
        assert [5 * plate + role for role in range(5)] in groups


def test_specks_among_the_dots_do_not_hide_a_plate() -> None:
    plate = blobs_of_base_dots(image_from_plate(0.5, 1.0, 2.0, 200.0)[None])
    rng = np.random.default_rng(5)
    low, high = plate.centres_px.min(axis=0), plate.centres_px.max(axis=0)
    specks = Blobs(rng.uniform(low, high, (200, 2)), np.full((200, 2), 0.2 * plate.semi_axes_px.min()))
    both = Blobs(np.vstack([plate.centres_px, specks.centres_px]), np.vstack([plate.semi_axes_px, specks.semi_axes_px]))
    assert [0, 1, 2, 3, 4] in group_base_dots(both, LEAST_FOCAL_PX).tolist()


@settings(max_examples=50)
@given(homography=views)
def test_dots_of_unlike_size_are_not_of_one_plate(homography: np.ndarray) -> None:
    blobs = blobs_of_base_dots(homography[None])
    swollen = blobs.semi_axes_px.copy()
    swollen[1] *= 3.0  # nine times the area; perspective gives 1.5
    assert not len(group_base_dots(Blobs(blobs.centres_px, swollen), LEAST_FOCAL_PX))


@settings(max_examples=50)
@given(homography=views)
def test_five_dots_with_e_elsewhere_are_not_a_target(homography: np.ndarray) -> None:
    """E moved to a place of the grid off both diagonals."""
    for cell in (1, 4, 7, 13):
        base_u = np.vstack([BASE_U[:4], PLATE_DOTS_U[cell]])
        centres_px = apply_homographies(homography[None], base_u)[0]
        axes_px = np.linalg.svd(homography_jacobians(homography[None], base_u)[0], compute_uv=False)
        for group in group_base_dots(Blobs(centres_px, axes_px), LEAST_FOCAL_PX).tolist():
            assert group[4] != 4


def test_few_blobs_make_no_group() -> None:
    for count in range(5):
        blobs = blobs_of_base_dots(image_from_plate(0.3, 0.0, 0.0, 100.0)[None])
        assert group_base_dots(Blobs(blobs.centres_px[:count], blobs.semi_axes_px[:count]), LEAST_FOCAL_PX).shape == (
            0,
            5,
        )
