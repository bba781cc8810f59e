from itertools import combinations

import numpy as np

from app.vision.kernels.fours import find_fours, match_relations
from app.vision.kernels.neighbours import find_nearest

AREA_RATIO_MAX = 3.5


def scattered(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Blobs of one size at random, and the six nearest of each."""
    centres_px = np.random.default_rng(count).uniform(0.0, 150.0, (count, 2))
    semi_axes_px = np.full((count, 2), 4.0)
    nearest = np.empty((count, 6), dtype=np.int64)
    find_nearest(centres_px, semi_axes_px, AREA_RATIO_MAX, nearest)
    return centres_px, semi_axes_px, nearest


def test_each_set_of_four_near_blobs_stands_once() -> None:
    centres_px, semi_axes_px, nearest = scattered(40)
    fours = [tuple(four) for four in find_fours(centres_px, semi_axes_px, nearest, 12.0).tolist()]
    expected = set()
    for blob, around in enumerate(nearest.tolist()):
        for others in combinations(around, 3):
            corners_px = centres_px[[blob, *others]]
            if np.linalg.norm(np.ptp(corners_px, axis=0)) < 12.0 * 4.0:
                expected.add(tuple(sorted([blob, *others])))
    assert len(fours) == len(set(fours)) > 20 and set(fours) == expected


def test_few_blobs_make_no_four() -> None:
    for count in range(1, 4):
        centres_px, semi_axes_px, nearest = scattered(count)
        assert find_fours(centres_px, semi_axes_px, nearest, 100.0).shape == (0, 4)


def test_a_relation_matches_where_its_sum_nearly_vanishes() -> None:
    centres_px, semi_axes_px, nearest = scattered(60)
    fours = find_fours(centres_px, semi_axes_px, nearest, 30.0)
    relations = np.array([[1.0, -1.0, 1.0, -1.0], [2.0, 1.0, 0.0, -3.0]])
    gap_px = np.linalg.norm(np.einsum("rk,mkc->mrc", relations, centres_px[fours]), axis=2)
    matches = match_relations(centres_px, semi_axes_px, fours, relations, 3.0)
    np.testing.assert_array_equal(matches, np.argwhere(gap_px < 3.0 * 4.0))
    assert len(matches) > 5
