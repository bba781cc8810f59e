import numpy as np
import pytest
from hypothesis import given, settings

from app.targets.layout import BASE_CELLS, DOT_RADIUS_U, PLATE_SIDE_U
from app.vision.dots import Blobs
from app.vision.homography import PLATE_DOTS_U, apply_homographies, homography_jacobians
from app.vision.proposals import BASE_U, GAPS_U, ProposalOptions, promising
from tests.vision.scenes import Shot, true_homographies
from tests.vision.views import views


def ideal_blobs(image_from_plate: np.ndarray) -> Blobs:
    """A, B, C, D, E of each plate in turn, as large as they are."""
    axes_px = np.linalg.svd(homography_jacobians(image_from_plate, BASE_U), compute_uv=False)
    return Blobs(apply_homographies(image_from_plate, BASE_U).reshape(-1, 2), axes_px.reshape(-1, 2))


def blobs_of(shot: Shot) -> Blobs:
    base_px = np.concatenate([target.dots_px[list(BASE_CELLS)] for target in shot.truth])
    # Plates of 4 px per u, some at a slant.
    return Blobs(base_px, np.full((len(base_px), 2), 3.5))


def drawn(image_from_plate: np.ndarray) -> tuple[np.ndarray, Blobs]:
    """Red dots on black where an ideal view has them, in a picture that holds them all."""
    blobs = ideal_blobs(image_from_plate[None])
    rows, columns = (np.ceil(blobs.centres_px.max(axis=0)) + 40).astype(int)[::-1]
    y, x = np.mgrid[0:rows, 0:columns]
    away_px = np.hypot(x[..., None] - blobs.centres_px[:, 0], y[..., None] - blobs.centres_px[:, 1])
    picture = np.full((rows, columns, 3), 24, dtype=np.uint8)
    picture[(away_px < np.maximum(blobs.semi_axes_px[:, 1], 1.5)).any(axis=2)] = (36, 28, 200)
    return picture, blobs


def test_gaps_are_the_plates_black() -> None:
    assert np.abs(GAPS_U).max() < PLATE_SIDE_U / 2
    away_u = np.linalg.norm(GAPS_U[:, None] - PLATE_DOTS_U, axis=2)
    assert away_u.min() > 2 * DOT_RADIUS_U  # as far from a dot's edge as the dot is wide, or nearly
    assert len(np.unique(GAPS_U, axis=0)) == 21
    np.testing.assert_array_equal(BASE_U, PLATE_DOTS_U[list(BASE_CELLS)])


def test_every_plate_of_a_photograph_is_promising_in_its_roles_alone(plates_shot: Shot) -> None:
    blobs, count = blobs_of(plates_shot), len(plates_shot.truth)
    right = np.arange(5 * count).reshape(count, 5)
    kept = promising(plates_shot.bgr, blobs, right)
    assert sorted(kept.tolist()) == right.tolist()
    orders = {
        "turned": [1, 2, 3, 0, 4],
        "mirrored": [0, 3, 2, 1, 4],
        "crossed": [0, 2, 1, 3, 4],
        "E for A": [4, 1, 2, 3, 0],
        "B for D": [0, 1, 2, 1, 4],
    }
    for name, order in orders.items():
        assert not len(promising(plates_shot.bgr, blobs, right[:, order])), name


def test_dots_of_two_plates_are_not_promising(plates_shot: Shot) -> None:
    blobs, count = blobs_of(plates_shot), len(plates_shot.truth)
    mixed = np.arange(5 * count).reshape(count, 5)
    mixed[:-1, 2] = mixed[1:, 2]  # C of the plate beside
    assert not len(promising(plates_shot.bgr, blobs, mixed[:-1]))


def test_without_black_between_nothing_is_promising(plates_shot: Shot) -> None:
    blobs, count = blobs_of(plates_shot), len(plates_shot.truth)
    groups = np.arange(5 * count).reshape(count, 5)
    assert not len(promising(np.full_like(plates_shot.bgr, (36, 28, 200)), blobs, groups))
    assert not len(promising(np.full_like(plates_shot.bgr, 24), blobs, groups))
    lifted = np.maximum(plates_shot.bgr, 225)  # the black is as bright as the red dots
    assert not len(promising(lifted, blobs, groups))


def test_a_few_gaps_may_be_covered_and_not_more(plates_shot: Shot) -> None:
    blobs, count = blobs_of(plates_shot), len(plates_shot.truth)
    homography = true_homographies(plates_shot)[:1]
    gaps_px = np.rint(apply_homographies(homography, GAPS_U)[0]).astype(int)
    spare = len(GAPS_U) - ProposalOptions().dark_gaps_min
    for covered, stands in ((spare - 2, True), (spare + 3, False)):  # some points lie on one pixel
        picture = plates_shot.bgr.copy()
        for x, y in gaps_px[-covered:]:
            picture[y - 1 : y + 2, x - 1 : x + 2] = 220
        kept = promising(picture, blobs, np.arange(5 * count).reshape(count, 5))[:, 0]
        assert (0 in kept) is stands


@pytest.mark.parametrize("factor", [0.3, 2.5])
def test_blobs_of_the_wrong_size_are_not_promising(plates_shot: Shot, factor: float) -> None:
    blobs, count = blobs_of(plates_shot), len(plates_shot.truth)
    wrong = Blobs(blobs.centres_px, factor * blobs.semi_axes_px)
    assert not len(promising(plates_shot.bgr, wrong, np.arange(5 * count).reshape(count, 5)))


def test_the_strongest_are_kept_when_there_are_too_many(plates_shot: Shot) -> None:
    blobs, count = blobs_of(plates_shot), len(plates_shot.truth)
    dimmed = plates_shot.bgr.copy()
    weak = plates_shot.truth[0].dots_px[list(BASE_CELLS)]
    for x, y in np.rint(weak).astype(int):
        dimmed[y - 5 : y + 6, x - 5 : x + 6] //= 2
    kept = promising(dimmed, blobs, np.arange(5 * count).reshape(count, 5), ProposalOptions(proposals_max=count - 1))
    assert sorted(kept[:, 0].tolist()) == list(range(5, 5 * count, 5))


def test_no_groups_stay_none(plates_shot: Shot) -> None:
    none = np.empty((0, 5), dtype=np.intp)
    assert promising(plates_shot.bgr, blobs_of(plates_shot), none).shape == (0, 5)


@settings(max_examples=40, deadline=None)
@given(image_from_plate=views)
def test_any_view_of_a_plate_is_promising(image_from_plate: np.ndarray) -> None:
    # Moved so that all of it is in the picture, and no larger than a picture may be.
    low = apply_homographies(image_from_plate[None], 1.5 * BASE_U[:4])[0].min(axis=0)
    moved = np.array([[1.0, 0.0, -low[0]], [0.0, 1.0, -low[1]], [0.0, 0.0, 1.0]]) @ image_from_plate
    picture, blobs = drawn(moved)
    assert promising(picture, blobs, np.arange(5)[None]).tolist() == [[0, 1, 2, 3, 4]]
