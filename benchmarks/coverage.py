"""Predicted accuracy beside redrawn resections: ``python -m benchmarks.coverage``.

Plans with other rooms, plates, cameras and lights; of each, views at random from those that can be located. All that
errs is redrawn (dots with what a plate shares, each target, the datum, the camera) and located by the resection. A
ratio is the root mean square error of the positions over the predicted standard deviation, 3-D.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import TargetMap
from app.photogrammetry.resection_equations import CameraPrior
from app.planning.coverage import headings_of, make_grid, poses_at
from app.planning.dot_errors import Light
from app.planning.plan_fields import fields_of_text
from app.planning.plan_file import Plan, plan_of_fields
from app.planning.planned_map import planned_map
from app.planning.predicted_accuracy import datum_covariances, information_of, position_covariances, radius95
from app.planning.predicted_views import MapArrays, PredictedViews, Seeing, predict_views
from app.planning.sight_lines import find_sight_lines
from benchmarks.coverage_draws import PlannedView, position_errors

Array = npt.NDArray[np.float64]

MM_PER_M = 1000.0
WITHIN = 0.15


@dataclass(frozen=True)
class Case:
    """A plan and the light in it."""

    name: str
    text: str
    light: Light = "indoor"


CASES = (
    Case("room 5 x 4 m, 40 of 14 mm, phone of the survey", "{room_m: [5, 4, 2.6], post: {count: 40}}"),
    Case(
        "hall 20 x 10 m, 100 of 20 mm, 4000 x 3000 px",
        "{room_m: [20, 10, 4], u_mm: 20, post: {count: 100, heights_m: [1, 2.5]}, camera: {width_px: 4000, height_px: "
        "3000}, view: {max_incidence_deg: 70}}",
    ),
    Case(
        "corridor 15 x 2 m, 30 of 14 mm, another unit of the model, dim",
        "{room_m: [15, 2, 2.6], post: {count: 30, spread: random, seed: 5}, camera: {width_px: 1920, height_px: 1080, "
        "hfov_deg: 70, dist: [0.1, -0.2, 0, 0, 0.05], known_from: model}}",
        "dim",
    ),
    Case(
        "room 7 x 5 m, 24 of 25 mm, upright phone known from EXIF, bright",
        "{room_m: [7, 5, 2.6], u_mm: 25, post: {count: 24}, camera: {width_px: 1920, height_px: 1440, "
        "known_from: exif}, view: {upright: true, map: {control_sigma_mm: 0}}}",
        "bright",
    ),
)


@dataclass(frozen=True)
class Comparison:
    """One view: targets in it, predicted and found figures, m, and the share of redraws that were located."""

    targets: int
    predicted_sigma_m: float
    found_rms_m: float
    predicted_radius_m: float
    within_radius: float
    located: float


def main() -> int:
    """Predict, redraw, print."""
    parser = argparse.ArgumentParser(prog="coverage", description=__doc__)
    parser.add_argument("--views", type=int, default=25, help="of each plan")
    parser.add_argument("--draws", type=int, default=200, help="of each view")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print("targets  views  sigma mm     all  median  5 % ... 95 %  beyond 15 %  in the radius  located")
    found = []
    for number, case in enumerate(CASES):
        rng = np.random.default_rng([arguments.seed, number])
        rows = list(compare(case, arguments.views, arguments.draws, rng))
        print(case.name)
        for least, below in ((2, 4), (4, 8), (8, 1000)):
            _print(
                f"{least}-{below - 1}" if below < 1000 else f"{least}+",
                [row for row in rows if least <= row.targets < below],
            )
        found += rows
    print("all")
    _print("", found)
    return 0


def compare(case: Case, views: int, draws: int, rng: np.random.Generator) -> Iterator[Comparison]:
    """Random views of a plan that are predicted to be located, each beside its redraws."""
    plan = plan_of_fields(fields_of_text(case.text.encode(), case.name), case.name)
    target_map, seeing = planned_map(plan), Seeing(plan.camera, plan.view.limits, case.light)
    wish = replace(plan.view, headings=1)
    grid = make_grid(target_map, plan.walls, wish)
    lines = find_sight_lines(
        grid.positions_m, target_map.targets, plan.walls, (plan.camera.camera.fx_px, seeing.limits)
    )
    while views > 0:
        at = int(rng.integers(len(grid.positions_m)))
        heading_rad = headings_of(wish) + rng.uniform(0.0, 2.0 * np.pi)
        poses = poses_at(grid.positions_m[at], heading_rad, wish)
        seen = predict_views(MapArrays.of(target_map.targets), lines.of(at), poses, seeing)
        if len(seen.target) >= seeing.limits.min_targets:
            yield _compare_one(plan, target_map, (seen, seeing), draws, rng)
            views -= 1


def _compare_one(
    plan: Plan, target_map: TargetMap, seen: tuple[PredictedViews, Seeing], draws: int, rng: np.random.Generator
) -> Comparison:
    views, seeing = seen
    pose = views.poses[0]
    datum = datum_covariances(target_map.datum, pose.position_m[None])
    covariance = position_covariances(information_of(views, CameraPrior.of(plan.camera)).matrices, datum)[0]
    in_view = replace(target_map, targets=tuple(target_map.targets[index] for index in views.target))
    view = PlannedView(pose, views.of(0), in_view, plan.camera, seeing.dot_errors)
    errors = [error for error in position_errors(view, draws, rng) if error is not None]
    away_m = np.linalg.norm(np.array(errors).reshape(-1, 3), axis=1)
    radius_m = float(radius95(covariance))
    located = len(errors) / draws
    rms_m, within = (
        (float(np.sqrt((away_m**2).mean())), float((away_m < radius_m).mean())) if errors else (np.nan, np.nan)
    )
    return Comparison(len(views.target), float(np.sqrt(np.trace(covariance))), rms_m, radius_m, within, located)


def pooled_ratio(rows: list[Comparison]) -> float:
    """Root mean square of the errors in units of the prediction, over all redraws that were located."""
    weights = np.array([row.located for row in rows])
    ratios = np.array([row.found_rms_m / row.predicted_sigma_m for row in rows])
    kept = weights > 0
    return float(np.sqrt(np.average(ratios[kept] ** 2, weights=weights[kept])))


def _print(name: str, rows: list[Comparison]) -> None:
    kept = [row for row in rows if row.located > 0]
    if not kept:
        return
    ratios = np.array([row.found_rms_m / row.predicted_sigma_m for row in kept])
    low, middle, high = np.quantile(ratios, [0.05, 0.5, 0.95])
    beyond = int((np.abs(ratios - 1.0) > WITHIN).sum())
    sigma_mm = MM_PER_M * float(np.median([row.predicted_sigma_m for row in kept]))
    inside, located = (float(np.mean([getattr(row, name) for row in kept])) for name in ("within_radius", "located"))
    print(
        f"{name:>7s} {len(rows):6d} {sigma_mm:9.2f} {pooled_ratio(rows):7.3f} {middle:7.3f}   {low:.2f} ... {high:.2f} "
        f"{beyond:12d} {100 * inside:12.1f} % {100 * located:7.1f} %",
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main())
