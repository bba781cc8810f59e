"""The start: within a few degrees of the truth, by majority, and with a proposal between any two targets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.rotation import angle_between_deg
from app.photogrammetry.resection_input import sight_targets
from app.photogrammetry.resection_start import StartOptions, find_start
from tests.photogrammetry.resection_scene import displaced, observe, room_scene

# One plate's tilt is good to a few degrees; further off, the adjustment might not find home.
GOOD_DEG, GOOD_M = 10.0, 0.8


def test_several_targets_elect_a_good_pose_in_every_scene() -> None:
    for seed in range(20):
        scene = room_scene(5, seed)
        start = find_start(
            sight_targets(observe(scene, np.random.default_rng(seed)), scene.target_map), scene.camera.camera
        )
        assert start is not None
        pose = start.pose(start.elected)
        assert angle_between_deg(pose.rotation, scene.site_from_cam.rotation) < GOOD_DEG
        assert np.linalg.norm(pose.position_m - scene.site_from_cam.position_m) < GOOD_M
        assert start.agreeing(start.elected).all()


def test_misread_codes_are_outvoted() -> None:
    good = 0
    for seed in range(30):
        scene = room_scene(6, seed)
        observations = observe(scene, np.random.default_rng(seed))
        first, second = observations[0], observations[1]
        swapped = [replace(first, code=second.code), replace(second, code=first.code), *observations[2:]]
        start = find_start(sight_targets(swapped, scene.target_map), scene.camera.camera)
        assert start is not None
        good += angle_between_deg(start.pose(start.elected).rotation, scene.site_from_cam.rotation) < GOOD_DEG
    assert good >= 27  # four good targets of six, each posed to a few degrees; sampling mends the rest


def test_exact_dots_propose_the_exact_pose() -> None:
    scene = room_scene(3, 4)
    start = find_start(sight_targets(observe(scene), scene.target_map), scene.camera.camera)
    assert start is not None
    np.testing.assert_allclose(start.pose(start.elected).position_m, scene.site_from_cam.position_m, atol=1e-4)


def test_the_proposal_between_two_targets_sees_the_other_best() -> None:
    scene = room_scene(4, 7)
    start = find_start(sight_targets(observe(scene, np.random.default_rng(1)), scene.target_map), scene.camera.camera)
    assert start is not None
    for proposer in range(4):
        for other in range(4):
            chosen = start.between(proposer, other)
            own = np.flatnonzero(start.proposers == proposer)
            assert chosen in own
            assert start.misses[chosen, other] == start.misses[own, other].min()


def test_targets_that_show_their_back_do_not_agree() -> None:
    scene = room_scene(4, 2)
    target = scene.target_map.targets[0]
    turned = displaced(target, np.zeros(3), np.pi * target.site_from_target.rotation[:, 1])
    with_back = scene.with_targets([turned, *scene.target_map.targets[1:]])
    start = find_start(sight_targets(observe(scene), with_back.target_map), scene.camera.camera)
    assert start is not None
    assert start.agreeing(start.elected).tolist() == [False, True, True, True]


def test_only_the_largest_propose() -> None:
    scene = room_scene(6, 3)
    seen = sight_targets(observe(scene), scene.target_map)
    start = find_start(seen, scene.camera.camera, StartOptions(proposers=2))
    assert start is not None
    sizes_px = np.ptp(seen.observed_px, axis=1).sum(axis=1)
    assert set(start.proposers.tolist()) == set(np.argsort(-sizes_px)[:2].tolist())


@pytest.mark.parametrize("cells", [(0, 1, 2), (0, 1, 2, 3)])
def test_no_target_with_enough_dots_gives_no_start(cells: tuple[int, ...]) -> None:
    scene = room_scene(2, 3)
    few = np.isin(np.arange(16), cells)
    observations = [replace(observation, measured=few) for observation in observe(scene)]
    assert find_start(sight_targets(observations, scene.target_map), scene.camera.camera) is None
