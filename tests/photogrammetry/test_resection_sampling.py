"""Sampling of pairs: who was moved is found, however many hide one another, and a draw is called a draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.photogrammetry.resection_consensus import Problem
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from app.photogrammetry.resection_sampling import SamplingOptions, find_consensus
from app.photogrammetry.resection_start import Start, find_start
from tests.photogrammetry.resection_scene import Scene, displaced, observe, pose_error, room_scene


def moved_problem(scene: Scene, moves: dict[int, Sequence[float]], seed: int = 0) -> tuple[Problem, Start]:
    """A photograph in which targets (by index) stand elsewhere than in the map: shift (m) and turn (rad) of each."""
    targets = list(scene.target_map.targets)
    for index, move in moves.items():
        targets[index] = displaced(targets[index], np.array(move[:3]), np.array(move[3:]))
    observations = observe(scene, np.random.default_rng(seed))
    sighted = sight_targets(observations, scene.with_targets(targets).target_map)
    start = find_start(sighted, scene.camera.camera)
    assert start is not None
    return Problem(sighted, CameraPrior.of(scene.camera)), start


def start_state(start: Start) -> State:
    return State(start.pose(start.elected), np.zeros(9))


# Shifts and turns from just beyond detection to a plate that was hung elsewhere.
@pytest.mark.parametrize("size", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("count", [1, 2, 4])
def test_moved_targets_of_ten_are_named_and_the_pose_is_that_of_the_others(count: int, size: float) -> None:
    scene = room_scene(10, 11)
    rng = np.random.default_rng(count)
    moved = rng.permutation(10)[:count]
    moves = {int(index): size * rng.choice([-1.0, 1.0], 6) * rng.uniform(0.6, 1.0, 6) for index in moved}
    problem, start = moved_problem(scene, moves)
    consensus = find_consensus(problem, start, start_state(start))
    assert set(np.flatnonzero(~consensus.agreeing)) == set(moves)
    assert consensus.has_majority and not consensus.contested
    error = pose_error(consensus.adjusted.state.site_from_cam, scene.site_from_cam)
    normalised = error @ consensus.adjusted.information[:6, :6] @ error
    assert normalised < 30.0  # a chi-square of at most six: exceeded once in 25,000


def test_targets_that_moved_together_are_outvoted() -> None:
    scene = room_scene(9, 12)
    move = [0.03, 0.05, -0.02, 0.0, 0.0, 0.03]
    problem, start = moved_problem(scene, dict.fromkeys((0, 3, 5, 8), move))
    consensus = find_consensus(problem, start, start_state(start))
    assert set(np.flatnonzero(~consensus.agreeing)) == {0, 3, 5, 8}


def test_two_targets_that_contradict_each_other_have_no_majority() -> None:
    problem, start = moved_problem(room_scene(2, 5), {0: [0.1, 0.0, 0.05, 0.0, 0.0, 0.0]})
    assert not find_consensus(problem, start, start_state(start)).has_majority


def test_two_against_two_have_no_majority() -> None:
    move = [0.3, 0.0, 0.2, 0.0, 0.2, 0.0]
    problem, start = moved_problem(room_scene(4, 6), {0: move, 1: move})
    assert not find_consensus(problem, start, start_state(start)).has_majority


def test_good_targets_are_all_kept_without_sampling() -> None:
    for seed in range(10):
        problem, start = moved_problem(room_scene(12, seed), {}, seed)
        no_samples = SamplingOptions(max_samples=0)
        consensus = find_consensus(problem, start, start_state(start), no_samples)
        assert consensus.agreeing.all()


def test_a_large_crowd_needs_no_sampling_for_covariances_that_promise_a_little_too_much() -> None:
    scene = room_scene(30, 2)
    for seed in range(5):
        problem, start = moved_problem(scene, {}, seed)
        sure = replace(problem, sighted=replace(problem.sighted, whiteners=1.6 * problem.sighted.whiteners))
        consensus = find_consensus(sure, start, start_state(start), SamplingOptions(max_samples=0))
        assert consensus.agreeing.sum() >= 29


def test_the_same_photograph_has_the_same_pose() -> None:
    problem, start = moved_problem(room_scene(8, 3), {2: [0.05] * 6, 4: [-0.04] * 6, 5: [0.03] * 6})
    first, second = (find_consensus(problem, start, start_state(start)) for _ in range(2))
    np.testing.assert_array_equal(first.adjusted.state.whitened, second.adjusted.state.whitened)


def test_a_swapped_pair_of_codes_is_left_out() -> None:
    scene = room_scene(7, 8)
    observations = observe(scene, np.random.default_rng(0))
    swapped = [
        replace(observations[0], code=observations[1].code),
        replace(observations[1], code=observations[0].code),
        *observations[2:],
    ]
    sighted = sight_targets(swapped, scene.target_map)
    start = find_start(sighted, scene.camera.camera)
    assert start is not None
    consensus = find_consensus(Problem(sighted, CameraPrior.of(scene.camera)), start, start_state(start))
    assert consensus.agreeing.tolist() == [False, False, *[True] * 5]
