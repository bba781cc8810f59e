"""How many targets, how large, how far: the tables of docs/planning.md by ``python -m benchmarks.posting``.

Rooms with targets at equal steps along the walls, low and high in turn; the planner's radius that holds 95 % of
positions over a grid at 1.5 m, a typical phone's 1080p frame known from the survey, indoor light.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import Datum, TargetMap
from app.photogrammetry.resection_equations import CameraPrior
from app.planning.coverage import Coverage, predict_coverage
from app.planning.plan_camera import SOURCES, default_camera, known_from
from app.planning.plan_fields import fields_of_text
from app.planning.plan_file import Plan, plan_of_fields
from app.planning.plan_view import MapExpectation, SightLimits
from app.planning.planned_map import planned_map, planned_target
from app.planning.posting import NORTH, UP, pose_facing
from app.planning.predicted_accuracy import information_of, position_covariances, radius95
from app.planning.predicted_views import MapArrays, Seeing, predict_views
from app.planning.scene import PostedTarget
from app.planning.survey_plan import look_at, phone_camera
from app.targets.choosing import choose_codes
from app.targets.family import family_by_name

Array = npt.NDArray[np.float64]

MM_PER_M = 1000.0
ROOMS_M = ((5.0, 4.0, 2.6), (10.0, 8.0, 3.0), (20.0, 10.0, 4.0))
COUNTS = (10, 20, 40, 80, 160)
MODULES_MM = (8.0, 14.0, 20.0, 30.0)
DISTANCES_M = (1.0, 2.0, 4.0, 8.0, 16.0)
SIZES_PX = ((1280, 720), (1920, 1080), (4000, 3000))
GROUP_M = ((-0.8, 0.4), (0.8, 0.4), (-0.8, -0.4), (0.8, -0.4))  # of four targets on one wall, about the line of sight


def main() -> int:
    """Predict, print."""
    parser = argparse.ArgumentParser(prog="posting", description=__doc__)
    parser.add_argument("--step-m", type=float, default=1.0)
    arguments = parser.parse_args()
    how_many(arguments.step_m)
    how_large(arguments.step_m)
    how_far()
    how_known(arguments.step_m)
    return 0


def how_many(step_m: float) -> None:
    """Rooms against numbers of targets of 14 mm."""
    print("\nHow many: u = 14 mm, up to 60 degrees; best heading, middle heading (share of positions located)\n")
    print("| room, m | " + " | ".join(f"{count} targets" for count in COUNTS) + " |")
    print("|---|" + "---|" * len(COUNTS))
    for room_m in ROOMS_M:
        cells = [_cell(_covered(_plan(room_m, count, 14.0), step_m)) for count in COUNTS]
        print(f"| {room_m[0]:g} x {room_m[1]:g} | " + " | ".join(cells) + " |")


def how_large(step_m: float) -> None:
    """Rooms against modules, forty targets."""
    print("\nHow large: 40 targets; best heading, middle heading (share of positions located)\n")
    print("| room, m | " + " | ".join(f"u = {module:g} mm" for module in MODULES_MM) + " |")
    print("|---|" + "---|" * len(MODULES_MM))
    for room_m in ROOMS_M:
        cells = [_cell(_covered(_plan(room_m, 40, module), step_m)) for module in MODULES_MM]
        print(f"| {room_m[0]:g} x {room_m[1]:g} | " + " | ".join(cells) + " |")


def how_far() -> None:
    """Four targets on one wall, seen from straight ahead; what the datum adds is left out."""
    print(
        "\nHow far: four targets of one wall, 1.6 x 0.8 m apart, straight ahead; 95 % radius, mm, without the datum\n"
    )
    print("| picture, px | u, mm | " + " | ".join(f"{distance:g} m" for distance in DISTANCES_M) + " | read up to, m |")
    print("|---|---|" + "---|" * (len(DISTANCES_M) + 1))
    for size_px in SIZES_PX:
        for module in MODULES_MM:
            cells = " | ".join(_from_afar(size_px, module, distance) for distance in DISTANCES_M)
            reach_m = phone_camera(*size_px).fx_px * module / MM_PER_M / SightLimits().min_px_per_u
            print(f"| {size_px[0]} x {size_px[1]} | {module:g} | {cells} | {reach_m:.1f} |")


def how_known(step_m: float) -> None:
    """Where the intrinsics come from, forty targets in the middle room."""
    print("\nHow well the camera is known: 10 x 8 m, 40 targets of 20 mm; best heading, middle heading\n")
    print("| intrinsics from | 95 % radius, mm |")
    print("|---|---|")
    plan = _plan(ROOMS_M[1], 40, 20.0)
    for source in SOURCES:
        camera = known_from(default_camera().camera, source)
        print(f"| {source} | {_cell(_covered(replace(plan, camera=camera), step_m))} |")


def _plan(room_m: tuple[float, float, float], count: int, module_mm: float) -> Plan:
    text = f"{{room_m: {list(room_m)}, u_mm: {module_mm}, post: {{count: {count}}}}}"
    return plan_of_fields(fields_of_text(text.encode(), "posting"), "posting")


def _covered(plan: Plan, step_m: float) -> Coverage:
    wish = replace(plan.view, step_m=step_m)
    return predict_coverage(planned_map(plan), plan.walls, Seeing(plan.camera, wish.limits), wish)


def _cell(coverage: Coverage) -> str:
    """Medians over the positions that are located, mm, and their share."""
    return ", ".join(_part(radii_m) for radii_m in (coverage.best_m, coverage.middle_m))


def _part(radii_m: Array) -> str:
    located = np.isfinite(radii_m)
    if not located.any():
        return "none"
    return f"{MM_PER_M * np.median(radii_m[located]):.1f} ({100 * located.mean():.0f} %)"


def _from_afar(size_px: tuple[int, int], module_mm: float, distance_m: float) -> str:
    seeing = Seeing(known_from(phone_camera(*size_px), "survey"))
    arrays = MapArrays.of(_group(module_mm / MM_PER_M).targets)
    pose = look_at(np.array([0.0, -distance_m, 1.5]), np.array([0.0, 0.0, 1.5]))
    views = predict_views(arrays, np.arange(len(GROUP_M)), (pose,), seeing)
    if len(views.target) < len(GROUP_M):
        return "-"
    information = information_of(views, CameraPrior.of(seeing.camera))
    return f"{MM_PER_M * float(radius95(position_covariances(information.matrices, np.zeros((3, 3))))[0]):.1f}"


def _group(u_m: float) -> TargetMap:
    codes = choose_codes(family_by_name("golay"), len(GROUP_M))
    places = [np.array([x_m, 0.0, 1.5 + z_m]) for x_m, z_m in GROUP_M]
    posted = [PostedTarget(code, pose_facing(-NORTH, UP, at_m), u_m) for code, at_m in zip(codes, places, strict=True)]
    targets = tuple(planned_target(target, MapExpectation()) for target in posted)
    return TargetMap(targets, Datum(np.zeros(3), np.zeros((7, 7))), "golay", u_m)


if __name__ == "__main__":
    sys.exit(main())
