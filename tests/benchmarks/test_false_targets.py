"""One picture of each hostile kind, and one of forced quintuples: nothing is accepted."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import triples
from benchmarks.false_targets import Level, accepted
from benchmarks.hostile_pictures import KINDS, hostile_picture
from benchmarks.quintuples import GROUNDS, Forced, count_forced, share_grouped

SEED = 11
NORMAL, NORMAL_LISTED = Level("normal", listed=False), Level("normal", listed=True)


@pytest.mark.parametrize("kind", KINDS)
def test_hostile_pictures_hold_no_target_of_a_site(kind: str) -> None:
    picture = hostile_picture(kind, SEED)
    assert accepted(picture, NORMAL_LISTED) == set()
    # Of words seen in a mirror one in 243 is a code both ways.
    assert len(accepted(picture, NORMAL)) <= (1 if kind == "plates in a mirror" else 0)
    np.testing.assert_array_equal(picture, hostile_picture(kind, SEED))


@pytest.mark.parametrize("ground", GROUNDS)
def test_quintuples_are_offered_by_the_grouping_and_none_is_accepted(ground: str) -> None:
    result = count_forced((ground, 3))
    assert result.drawn == 108 and result.grouped > 50
    assert (result.accepted, result.listed) == (0, 0)
    assert result + Forced(1, 2, 3, 4) == Forced(109, result.grouped + 2, 3, 4)


def test_few_random_quintuples_look_like_base_dots() -> None:
    assert 0.0 < share_grouped(2_000, seed=2) < 0.03


@pytest.mark.parametrize("ground", GROUNDS)
def test_triples_beside_a_board_are_offered_and_none_is_accepted(ground: str) -> None:
    result = triples.count_forced((ground, 3))
    assert result.drawn == 108 and result.grouped > 20
    assert (result.accepted, result.listed) == (0, 0)


def test_half_of_random_triples_look_like_e_and_two_corners() -> None:
    assert 0.4 < triples.share_offered(500, seed=2) < 0.6
