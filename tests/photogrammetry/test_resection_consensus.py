"""Consensus per target: the test's distribution, and what it does to targets that were moved, swapped or bent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from app.photogrammetry.resection_adjustment import adjust_pose
from app.photogrammetry.resection_consensus import (
    ConsensusOptions,
    Problem,
    consent,
    movements_chi2,
    own_scatter,
    settle,
)
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from tests.photogrammetry.resection_scene import Scene, displaced, observe, redrawn_map, room_scene

OPTIONS = ConsensusOptions()


def problem_of(scene: Scene, seed: int | None = 0) -> Problem:
    """A redrawn photograph of a scene; exact dots without a seed."""
    rng = None if seed is None else np.random.default_rng(seed)
    target_map = scene.target_map if rng is None else redrawn_map(scene.target_map, rng)
    return Problem(sight_targets(observe(scene, rng), target_map), CameraPrior.of(scene.camera))


def at_truth(scene: Scene) -> State:
    return State(scene.site_from_cam, np.zeros(9))


def test_movements_of_good_targets_follow_the_chi_square_of_six() -> None:
    scene = room_scene(8, 1)
    draws = [problem_of(scene, seed) for seed in range(150)]
    movements = np.concatenate([movements_chi2(adjust_pose(p.sighted, p.prior, at_truth(scene))) for p in draws])
    # 150 independent photographs of eight targets; a chi-square of six has mean 6 and sigma sqrt(12): 4 sigmas of the
    # mean of 150 sums of eight, whose targets correlate little.
    assert movements.mean() == pytest.approx(6.0, abs=4.0 * np.sqrt(12.0 / (150 * 8)) * 1.5)
    share = (movements > chi2.ppf(0.95, 6)).mean()
    assert share == pytest.approx(0.05, abs=4.0 * np.sqrt(0.05 * 0.95 / (150 * 8)) * 1.5)


def test_movement_against_the_others_is_what_leaving_the_target_out_gives() -> None:
    scene = room_scene(5, 2)
    problem = problem_of(scene, 3)
    everyone = np.ones(5, dtype=np.bool_)
    inside = consent(problem, everyone, at_truth(scene), OPTIONS).excess[2]
    outside = consent(problem, np.arange(5) != 2, at_truth(scene), OPTIONS).excess[2]
    # Equal in a linear problem; millimetres over metres leave parts in a thousand.
    assert inside == pytest.approx(outside, rel=0.02)


def test_one_target_alone_has_nothing_to_disagree_with() -> None:
    problem = problem_of(room_scene(1, 2))
    alone = consent(problem, np.ones(1, dtype=np.bool_), at_truth(room_scene(1, 2)), OPTIONS)
    assert alone.fits and alone.has_majority
    assert alone.excess.tolist() == [0.0]


def test_settling_leaves_out_the_moved_and_takes_back_the_wrongly_left_out() -> None:
    scene = room_scene(6, 4)
    targets = list(scene.target_map.targets)
    targets[1] = displaced(targets[1], np.array([0.0, 0.0, 0.03]), np.zeros(3))
    problem = problem_of(scene.with_targets(targets), None)
    observed = problem_of(scene, None).sighted
    problem = replace(problem, sighted=replace(problem.sighted, observed_px=observed.observed_px))
    first = consent(problem, np.isin(np.arange(6), [0, 2, 3]), at_truth(scene), OPTIONS)
    settled = settle(problem, first, OPTIONS)
    assert settled.agreeing.tolist() == [True, False, True, True, True, True]
    assert settled.fits and settled.has_majority
    assert settled.cost == pytest.approx(1.0, abs=0.05)


def test_scatter_is_one_for_honest_covariances_and_grows_with_dishonest_ones() -> None:
    scene = room_scene(24, 6)
    flattered = [replace(target, covariance=target.covariance / 100.0) for target in scene.target_map.targets]
    everyone = np.ones(24, dtype=np.bool_)
    honest, dishonest = [], []
    for seed in range(5):
        rng = np.random.default_rng(seed)
        drawn, observations = redrawn_map(scene.target_map, rng), observe(scene, rng, sigma_px=0.03)
        sure = scene.with_targets(
            [replace(t, covariance=f.covariance) for t, f in zip(drawn.targets, flattered, strict=True)]
        ).target_map
        for target_map, found in ((drawn, honest), (sure, dishonest)):
            problem = Problem(sight_targets(observations, target_map), CameraPrior.of(scene.camera))
            found.append(own_scatter(problem, consent(problem, everyone, at_truth(scene), OPTIONS), OPTIONS))
    assert np.mean(honest) < 1.5
    assert np.mean(dishonest) > 2.0


def test_few_targets_must_fit_as_they_say() -> None:
    scene = room_scene(4, 6)
    problem = problem_of(scene, 1)
    flattered = replace(problem.sighted, whiteners=10.0 * problem.sighted.whiteners)
    problem = replace(problem, sighted=flattered)
    consensus = consent(problem, np.ones(4, dtype=np.bool_), at_truth(scene), OPTIONS)
    assert own_scatter(problem, consensus, OPTIONS) == 1.0
