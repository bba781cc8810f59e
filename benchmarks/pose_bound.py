"""Poses beside the Cramer-Rao bound, and whether their covariances hold: ``python -m benchmarks.pose_bound``.

Synthesised observations, with all that errs redrawn: dots with what a plate shares, map, camera. The bound is the
inverse information of pose and camera at the truth, prior included; that of the good targets where some are displaced.
Efficiency is the root mean square error of the position over the bound's; 1 is perfect. NEES is 6 when the covariance
is honest.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.target_map import TargetMap
from app.photogrammetry.resection import resect
from app.photogrammetry.resection_adjustment import evaluate
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from benchmarks.pose_scene import View, ViewOptions, draw, make_view, moved, pose_error

Array = npt.NDArray[np.float64]

MM_PER_M = 1000.0
DISPLACED_M, TURNED_RAD = 0.1, 0.1  # of an outlier: a plate that was hung elsewhere
EXIF_SHARE, CALIBRATED_SHARE = 0.02, 3e-3


@dataclass(frozen=True)
class Case:
    """One row: what is seen and how many of the targets are displaced."""

    name: str
    options: ViewOptions
    outliers: int = 0


def main() -> int:
    """Redraw, locate, print."""
    parser = argparse.ArgumentParser(prog="pose_bound", description=__doc__)
    parser.add_argument("--views", type=int, default=40)
    parser.add_argument("--draws", type=int, default=5)
    arguments = parser.parse_args()
    print(f"{'case':34s} {'located':>8s} {'rmse mm':>9s} {'bound mm':>9s} {'over it':>8s} {'NEES':>6s}")
    for case in _cases():
        _print(case, np.array(list(_rows(case, arguments.views, arguments.draws))), arguments.views * arguments.draws)
    return 0


def _cases() -> Iterator[Case]:
    near = ViewOptions()
    for targets in (1, 2, 3, 5, 20, 100):
        distance_m = 1.5 if targets == 1 else 4.0
        yield Case(f"{targets} targets at {distance_m:g} m", replace(near, targets=targets, distance_m=distance_m))
    for distance_m in (1.0, 2.0, 8.0):
        yield Case(f"5 targets at {distance_m:g} m", replace(near, distance_m=distance_m))
    for targets, outliers in ((5, 1), (10, 3), (20, 8)):
        yield Case(f"{targets} targets, {outliers} displaced", replace(near, targets=targets), outliers)
    for share in (CALIBRATED_SHARE, EXIF_SHARE):
        yield Case(f"20 targets, focal length to {100 * share:g} %", replace(near, targets=20, focal_share=share))


def _rows(case: Case, views: int, draws: int) -> Iterator[tuple[float, float, float]]:
    """Squared error of the position and its bound, m^2, and the normalised error squared of each located redraw."""
    for seed in range(views):
        view, rng = make_view(case.options, seed), np.random.default_rng([2, seed])
        bound_m2 = _bound_m2(view, case.outliers)
        for _ in range(draws):
            observations, target_map, camera = draw(view, rng)
            try:
                located = resect(observations, _disturbed(target_map, case.outliers, rng), camera)
            except NotLocated:
                continue
            error = pose_error(located.site_from_cam, view.site_from_cam)
            yield float(error[:3] @ error[:3]), bound_m2, float(error @ np.linalg.solve(located.covariance, error))


def _bound_m2(view: View, outliers: int) -> float:
    """Least variance of the position, 3-D, of an unbiased estimate that knows the good targets: the last ones."""
    observations, target_map, _ = draw(view, np.random.default_rng(0))
    sighted = sight_targets(observations[outliers:], replace(target_map, targets=view.target_map.targets))
    at_truth = evaluate(sighted, CameraPrior.of(view.camera), State(view.site_from_cam, np.zeros(9)))
    return float(np.trace(np.linalg.inv(at_truth.information)[:3, :3]))


def _disturbed(target_map: TargetMap, outliers: int, rng: np.random.Generator) -> TargetMap:
    """The map with its first targets displaced."""
    scale = np.array([DISPLACED_M] * 3 + [TURNED_RAD] * 3)
    first = [moved(target, scale * rng.normal(size=6)) for target in target_map.targets[:outliers]]
    return replace(target_map, targets=(*first, *target_map.targets[outliers:]))


def _print(case: Case, rows: Array, total: int) -> None:
    if not len(rows):
        print(f"{case.name:34s} {0:7d} %")
        return
    rmse_m, bound_m = np.sqrt(rows[:, :2].mean(axis=0))
    share = 100.0 * len(rows) / total
    figures = f"{MM_PER_M * rmse_m:9.2f} {MM_PER_M * bound_m:9.2f} {rmse_m / bound_m:8.2f} {rows[:, 2].mean():6.2f}"
    print(f"{case.name:34s} {share:6.1f} % {figures}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
