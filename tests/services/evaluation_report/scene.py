"""Systems beside a reference, to report on: with faults of all kinds, gaps, zones, and hostile names."""

from __future__ import annotations

import numpy as np

from app.services.evaluation_report.material import ReportMaterial
from app.trajectories.alignment import AlignmentOptions
from app.trajectories.comparison import compare
from app.trajectories.evaluation import Evaluation, EvaluationOptions, evaluate
from app.trajectories.metrics.bootstrap import BootstrapOptions
from app.trajectories.metrics.zones import Zone
from app.trajectories.trajectory import Trajectory
from tests.services.reporting.names import HOSTILE
from tests.trajectories.walks import START_S, walk, walk_at

FEW = BootstrapOptions(resamples=100)
SAME_MOMENT_S = 0.1
REFERENCE_M2 = np.diag([4e-4, 4e-4, 9e-4, 1e-6, 1e-6, 1e-6])
ZONES = (
    Zone("atrium", np.array([[0.0, -2.6], [4.6, -2.6], [4.6, 2.6], [0.0, 2.6]])),
    Zone("corridor", np.array([[-4.6, -2.6], [-2.0, -2.6], [-2.0, 2.6], [-4.6, 2.6]])),
)


def system(sigma_m: float, seed: int, bias_m: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Trajectory:
    """What a system with noise and a bias says at stamps of its own."""
    true = walk_at(START_S + np.arange(0.5, 58.0, 0.37))
    noise_m = np.random.default_rng(seed).normal(0.0, sigma_m, true.positions_m.shape)
    return Trajectory(true.times_s, true.positions_m + noise_m + bias_m, true.orientations_xyzw)


def away(trajectory: Trajectory) -> Trajectory:
    """Silent for a while, and without orientations."""
    seconds = trajectory.times_s - START_S
    said = trajectory.take(np.flatnonzero((seconds < 20.0) | (seconds > 32.0)))
    return Trajectory(said.times_s, said.positions_m)


def astray(trajectory: Trajectory) -> Trajectory:
    """With three positions that are gross errors."""
    positions_m = trajectory.positions_m.copy()
    positions_m[[20, 60, 100]] += [[30.0, 5.0, 2.0], [-8.0, 25.0, -3.0], [4.0, -40.0, 9.0]]
    return Trajectory(trajectory.times_s, positions_m, trajectory.orientations_xyzw)


def evaluated(estimate: Trajectory, options: EvaluationOptions | None = None) -> Evaluation:
    reference = walk(60.0, 10.0, covariances=np.tile(REFERENCE_M2, (600, 1, 1)))
    return evaluate(reference, estimate, options or EvaluationOptions(zones=ZONES, bootstrap=FEW))


def material_of(evaluations: dict[str, Evaluation], zones: tuple[Zone, ...] = ZONES) -> ReportMaterial:
    differences = compare(evaluations, SAME_MOMENT_S, FEW)
    return ReportMaterial("Hall 3", "trajectory 17", evaluations, differences, zones)


def several() -> ReportMaterial:
    aligned = EvaluationOptions(alignment=AlignmentOptions("posyaw"), zones=ZONES, bootstrap=FEW)
    return material_of(
        {
            "UWB": evaluated(system(0.08, 1)),
            "Wi-Fi": evaluated(away(system(0.5, 2, (0.3, -0.1, 0.2)))),
            "ARKit": evaluated(astray(system(0.02, 3))),
            "turned": evaluated(system(0.1, 4), aligned),
        }
    )


def hostile() -> ReportMaterial:
    """Every name of the worst kind."""
    one = evaluated(system(0.08, 1), EvaluationOptions(zones=(Zone(HOSTILE[2], ZONES[0].corners_m),), bootstrap=FEW))
    zones = (Zone(HOSTILE[2], ZONES[0].corners_m),)
    evaluations = dict.fromkeys(HOSTILE, one)
    return ReportMaterial(HOSTILE[0], HOSTILE[1], evaluations, compare(evaluations, SAME_MOMENT_S, FEW), zones)
