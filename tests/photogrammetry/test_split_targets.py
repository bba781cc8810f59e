"""Sightings that fall into two groups tell of a moved target; noise, one bad sighting and a bad photograph do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.pose import Pose
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.network import Network
from app.photogrammetry.split_targets import SplitOptions, split_targets
from tests.photogrammetry.survey_scene import NOISE_PX, Room, build_room, ring_of_stations
from tests.photogrammetry.true_network import see

ROOM = build_room()
STATIONS = ring_of_stations(24)
MOVED = 105
# Dots of 0.1 px at 1400 px and some metres: a tenth of a millimetre across a ray by a dozen dots, ten times that along.
PLACE_M = 0.001


def seen_in_two_states(after: Room, later: np.ndarray) -> tuple[BundleProblem, Network, int]:
    """Some photographs show the room as it was later; the network is the first state's truth."""
    truth, changed = (see(room, STATIONS, noise_px=NOISE_PX) for room in (ROOM, after))
    dots_px = truth.sightings.dots_px.copy()
    target = int(np.flatnonzero(truth.codes == MOVED)[0])
    rows = (truth.sightings.target == target) & np.isin(truth.sightings.photo, later)
    dots_px[rows] = changed.sightings.dots_px[rows]
    return truth.problem.with_sightings(replace(truth.sightings, dots_px=dots_px)), truth.network, target


def pushed(distance_m: float) -> Room:
    pose = ROOM.poses[MOVED]
    return ROOM.with_pose(MOVED, Pose(pose.rotation, pose.position_m + distance_m * pose.rotation[:, 0]))


@pytest.mark.parametrize("distance_m", [0.003, 0.005])
def test_a_target_pushed_between_photographs_stands_in_two_places(distance_m: float) -> None:
    problem, network, target = seen_in_two_states(pushed(distance_m), np.arange(0, 24, 2))
    (found,) = split_targets(problem, network, 1.0, SplitOptions())
    assert found.target == target
    assert found.apart_m == pytest.approx(distance_m, abs=PLACE_M)


def test_noise_is_no_movement() -> None:
    problem, network, _ = seen_in_two_states(ROOM, np.arange(0))
    assert not split_targets(problem, network, 1.0, SplitOptions(least_sigmas=1.0))


def test_one_sighting_alone_tells_nothing() -> None:
    problem, network, target = seen_in_two_states(ROOM, np.arange(0))
    photo = int(problem.sightings.photo[problem.sightings.target == target][0])
    alone, _, _ = seen_in_two_states(pushed(0.005), np.array([photo]))
    assert not split_targets(alone, network, 1.0, SplitOptions())
