"""Sightings that fall into two groups tell of a moved target; noise, breathing and one bad sighting do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import chdtrc, chndtr

from app.geometry.pose import Pose
from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.network import POSE_COUNT
from app.photogrammetry.sightings import Sightings
from app.photogrammetry.split_targets import SplitOptions, SplitTarget, split_of, surest_around
from app.photogrammetry.target_pulls import TargetPulls, target_pulls
from tests.photogrammetry.survey_scene import NOISE_PX, Room, build_room, ring_of_stations
from tests.photogrammetry.true_network import see

ROOM = build_room()
STATIONS = ring_of_stations(24)
MOVED = 105
# Dots of 0.1 px at 1400 px and some metres: a tenth of a millimetre across a ray by a dozen dots, ten times that along.
PLACE_M = 0.001
FAR_M = 0.05


def split_targets(pulls: Sequence[TargetPulls], sightings: Sightings) -> tuple[SplitTarget, ...]:
    found = [split_of(one, len(pulls), SplitOptions()) for one in pulls]
    return surest_around([split for split in found if split is not None], sightings)


def found_in_two_states(after: Room, later: np.ndarray) -> tuple[tuple[SplitTarget, ...], int]:
    """What is found when some photographs show the room as it was later, and the target that it should be."""
    truth, changed = (see(room, STATIONS, noise_px=NOISE_PX) for room in (ROOM, after))
    dots_px = truth.sightings.dots_px.copy()
    target = int(np.flatnonzero(truth.codes == MOVED)[0])
    rows = (truth.sightings.target == target) & np.isin(truth.sightings.photo, later)
    dots_px[rows] = changed.sightings.dots_px[rows]
    problem = truth.problem.with_sightings(replace(truth.sightings, dots_px=dots_px))
    network = adjust_bundle(problem, truth.network).network
    pulls = tuple(target_pulls(problem, network, BundleOptions().loss))
    return split_targets(pulls, problem.sightings), target


def pushed(distance_m: float) -> Room:
    pose = ROOM.poses[MOVED]
    return ROOM.with_pose(MOVED, Pose(pose.rotation, pose.position_m + distance_m * pose.rotation[:, 0]))


@pytest.mark.parametrize("distance_m", [0.003, 0.01])
def test_a_target_pushed_between_photographs_stands_in_two_places(distance_m: float) -> None:
    (found,), target = found_in_two_states(pushed(distance_m), np.arange(0, 24, 2))
    assert (found.target, found.lone) == (target, None)
    assert found.apart_m == pytest.approx(distance_m, abs=PLACE_M)


def test_noise_is_no_movement() -> None:
    assert not found_in_two_states(ROOM, np.arange(0))[0]


def test_one_sighting_alone_is_false_and_nothing_has_moved() -> None:
    truth = see(ROOM, STATIONS, noise_px=NOISE_PX)
    every = tuple(target_pulls(truth.problem, truth.network, BundleOptions().loss))
    one, steps = every[0], np.zeros_like(every[0].pulls)
    steps[0, :3] = FAR_M
    there = np.tensordot(one.information, steps, axes=2)
    shown = replace(one, pulls=there, squares=float((there * steps).sum()))
    pulls = [shown, *(replace(other, squares=0.0) for other in every[1:])]
    (found,) = split_targets(pulls, truth.sightings)
    assert (found.target, found.lone) == (one.target, one.rows[0])
    assert found.apart_m == pytest.approx(np.sqrt(3.0) * FAR_M, rel=1e-3)


@pytest.mark.parametrize(("sightings", "targets"), [(4, 20), (12, 400), (30, 10_000)])
def test_limits_keep_the_stated_rates(sightings: int, targets: int) -> None:
    options = SplitOptions(lens_factor=1.0)
    tests = targets * 2.0 ** (sightings - 1)
    limit = options.limit(sightings, targets)
    assert tests * chdtrc(POSE_COUNT, limit) == pytest.approx(options.false_alarms, rel=1e-6)
    assert chndtr(limit, POSE_COUNT, options.found_from(sightings, targets)) == pytest.approx(1 - options.power)
    assert SplitOptions().limit(sightings, targets) == pytest.approx(SplitOptions().lens_factor * limit)
