"""A photograph with a wrong pose gets the right one from the map around it; nothing of it is called false."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.rotation import exp_rotation, log_rotation
from app.photogrammetry.cleaning import clean_network, held_part
from app.photogrammetry.cleaning_state import untouched
from app.photogrammetry.growth import Growth, GrowthOptions
from app.photogrammetry.initial_network import grow_networks
from app.photogrammetry.quality import QualityOptions
from app.photogrammetry.second_look import look_again
from app.photogrammetry.survey_input import read_survey
from tests.photogrammetry.survey_scene import PLATE, build_room, ring_of_stations, survey_photos

WRONG = 5
# Of a dozen targets with 0.1 px at 1400 px: a fifth of a milliradian.
ORIENTED_RAD = 1e-3


@pytest.fixture(scope="module")
def grown() -> Growth:
    survey = read_survey(survey_photos(build_room(), ring_of_stations(16)), PLATE)
    (network,) = grow_networks(survey.problem, GrowthOptions(), [].append)
    return network


def mirrored(growth: Growth, photo: int) -> Growth:
    """The photograph looks at the middle of its targets from the other side of their common normal."""
    network, seen = growth.network, growth.problem.sightings
    targets = seen.target[seen.photo == photo]
    middle_m, normal = network.target_positions_m[targets].mean(axis=0), network.target_rotations[targets][0, :, 2]
    turn = exp_rotation(np.pi * normal)
    rotations, positions_m = network.photo_rotations.copy(), network.photo_positions_m.copy()
    rotations[photo] = turn @ rotations[photo]
    positions_m[photo] = middle_m + turn @ (positions_m[photo] - middle_m)
    return replace(growth, network=replace(network, photo_rotations=rotations, photo_positions_m=positions_m))


def off_rad(growth: Growth, right: Growth) -> float:
    turn = growth.network.photo_rotations[WRONG] @ right.network.photo_rotations[WRONG].T
    return float(np.linalg.norm(log_rotation(turn)))


def test_a_mirrored_photograph_is_turned_back(grown: Growth) -> None:
    wrong = mirrored(grown, WRONG)
    assert off_rad(wrong, grown) > 1.0
    state = look_again(untouched(wrong), *held_part(wrong), QualityOptions())
    assert off_rad(state.growth, grown) < ORIENTED_RAD
    assert np.flatnonzero(state.looked).tolist() == [WRONG]


def test_nobody_is_asked_twice(grown: Growth) -> None:
    wrong = mirrored(grown, WRONG)
    state = replace(untouched(wrong), looked=np.ones(grown.problem.sightings.photo_count, dtype=np.bool_))
    assert look_again(state, *held_part(wrong), QualityOptions()) is state


def test_a_sound_network_stays_as_it_is(grown: Growth) -> None:
    state = untouched(grown)
    assert look_again(state, *held_part(grown), QualityOptions()) is state


def test_cleaning_loses_nothing_of_a_photograph_with_a_wrong_pose(grown: Growth) -> None:
    clean = clean_network(mirrored(grown, WRONG), QualityOptions(), lambda: None)
    assert not clean.findings.sightings
    assert not clean.findings.photos
    assert WRONG in clean.part.photos
