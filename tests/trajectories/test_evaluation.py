from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.trajectories.alignment import AlignmentOptions
from app.trajectories.association import AssociationOptions
from app.trajectories.comparison import Difference, compare
from app.trajectories.evaluation import EvaluationOptions, evaluate
from app.trajectories.lever_arm import with_lever_arm
from app.trajectories.metrics.bootstrap import BootstrapOptions, Interval
from app.trajectories.metrics.zones import Zone
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import START_S, noisy, walk, walk_at

FEW = BootstrapOptions(resamples=200)
SIGMA_M = 0.1


def reference() -> Trajectory:
    return walk(60.0, 10.0, covariances=np.tile(1e-6 * np.eye(6), (600, 1, 1)))


def system(sigma_m: float = SIGMA_M, seed: int = 1) -> Trajectory:
    """Positions of a system at stamps of its own."""
    said = noisy(walk_at(START_S + np.arange(0.5, 58.0, 0.37)), sigma_m, seed)
    return Trajectory(said.times_s, said.positions_m)


def test_the_whole_story_gives_back_what_was_put_in() -> None:
    options = EvaluationOptions(
        association=AssociationOptions(course="spline"),
        alignment=AlignmentOptions("posyaw"),
        time_offset_s=None,
        lever_arm_m=np.array([0.0, 0.1, 0.05]),
        zones=(Zone("east", np.array([[0, -9], [9, -9], [9, 9], [0, 9]], float)),),
        bootstrap=FEW,
    )
    antenna = with_lever_arm(walk_at(START_S + np.arange(0.5, 58.0, 0.37)), np.array([0.0, 0.1, 0.05]))
    said = noisy(antenna, SIGMA_M)
    found = evaluate(reference(), Trajectory(said.times_s - 12.5, said.positions_m), options)
    assert found.time_offset.offset_s == pytest.approx(12.5, abs=5 * found.time_offset.sigma_s)
    # RMS of 3 n normal errors scatters by 1 / sqrt(6 n): 3 % for 156 pairs.
    assert found.accuracy.spatial.rms == pytest.approx(SIGMA_M * np.sqrt(3), rel=0.12)
    assert found.intervals.rms.low < found.accuracy.spatial.rms < found.intervals.rms.high
    assert found.verdict is not None and found.verdict.distinguishable
    assert found.availability.covered_share == pytest.approx(1.0, abs=0.03)
    assert set(found.zones) == {"east", "elsewhere"}
    assert found.floors is None and found.evaal.rms == pytest.approx(found.accuracy.horizontal.rms)
    assert found.alignment.pairs_used == len(found.pairs)


def test_a_reference_against_itself_is_without_error() -> None:
    found = evaluate(reference(), reference(), EvaluationOptions(bootstrap=FEW))
    assert found.accuracy.spatial.greatest < 1e-12
    assert found.verdict is not None and not found.verdict.distinguishable
    assert found.availability.covered_share == 1.0


def test_systems_are_compared_at_common_moments() -> None:
    good = system(0.05)
    mirrored_m = 2 * walk_at(good.times_s).positions_m - good.positions_m  # other errors of the same size
    runs = {"good": good, "bad": system(0.2, seed=2), "twin": Trajectory(good.times_s, mirrored_m)}
    evaluations = {
        name: evaluate(walk_at(good.times_s), run, EvaluationOptions(bootstrap=FEW)) for name, run in runs.items()
    }
    differences = {(item.first, item.second): item for item in compare(evaluations, 0.01, FEW)}
    assert set(differences) == {("good", "bad"), ("good", "twin"), ("bad", "twin")}
    assert differences["good", "bad"].better == "good" and differences["bad", "twin"].better == "twin"
    same = differences["good", "twin"].mean_m
    assert same is not None and abs(same.value) < 1e-15
    assert differences["good", "bad"].common == len(evaluations["good"].pairs)


def test_an_interval_around_zero_names_no_better_one() -> None:
    assert Difference("a", "b", 9, Interval(0.1, -0.1, 0.3, 1)).better is None
    assert Difference("a", "b", 9, Interval(0.1, 0.05, 0.3, 1)).better == "b"
    assert Difference("a", "b", 9, Interval(-0.1, -0.2, -0.05, 1)).better == "a"


def test_systems_that_never_spoke_together_have_no_difference() -> None:
    early, late = system(), system()
    runs = {"early": early.take(np.arange(20)), "late": late.take(np.arange(100, 120))}
    evaluations = {name: evaluate(reference(), run, EvaluationOptions(bootstrap=FEW)) for name, run in runs.items()}
    (difference,) = compare(evaluations, 0.01, FEW)
    assert difference.common == 0 and difference.mean_m is None and difference.better is None


def test_options_are_honoured_not_ignored() -> None:
    plain = evaluate(reference(), system(), EvaluationOptions(bootstrap=FEW))
    shifted = evaluate(reference(), system(), EvaluationOptions(time_offset_s=0.5, bootstrap=FEW))
    assert shifted.accuracy.spatial.rms > 2 * plain.accuracy.spatial.rms
    upstairs = replace(system(), floors=np.ones(len(system()), dtype=np.int64))
    floors = evaluate(reference(), upstairs, EvaluationOptions(floor_height_m=3.0, bootstrap=FEW)).floors
    assert floors is not None and floors.detection_probability == 0.0
