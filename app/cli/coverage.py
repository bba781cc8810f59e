"""``scattermark coverage``: predicted accuracy over a site, and where the next target should go."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, at_least_one, non_negative, positive
from app.cli.compile_ import compile_first
from app.cli.progress import progress
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.geometry.camera import CalibratedCamera
    from app.planning.plan_view import SightLimits, ViewWish
    from app.services.coverage_report.prediction import Prediction

HELP = "predict how well cameras will be located over a site, and where the next target should go"
# Tests hold these equal to the library's lists, whose import is slow.
LIGHTS = ("bright", "indoor", "dim")
OVERS = ("best", "middle", "worst")
SUFFIXES = (".json", ".svg", ".png")
MM_PER_M = 1000.0


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--plan", type=Path, metavar="PLAN", help="walls, targets, camera and view: YAML or JSON")
    what.add_argument("--map", type=Path, metavar="MAP.json", help="the map of a survey (scattermark build)")
    parser.add_argument("--walls", type=Path, metavar="PLAN", help="with --map: a plan whose walls hide and carry")
    parser.add_argument("--camera", type=Path, metavar="FILE.json", help="the camera (the plan's, or the survey's)")
    parser.add_argument("--out", type=_out, action="append", default=[], metavar="FILE", help=".svg, .png or .json")
    parser.add_argument("--height-m", type=float, help="of the camera (1.5)")
    parser.add_argument("--step-m", type=positive, help="between positions (0.5)")
    parser.add_argument("--headings", type=at_least_one, help="directions at each position (16)")
    parser.add_argument("--pitch-deg", type=float, help="upwards (0)")
    parser.add_argument("--upright", action="store_true", default=None, help="the camera is held upright")
    parser.add_argument("--area-m", type=float, nargs=4, metavar=("X0", "Y0", "X1", "Y1"), help="(what walls enclose)")
    parser.add_argument("--clearance-m", type=non_negative, help="from walls (0.25)")
    parser.add_argument("--min-px-per-u", type=positive, help="least size of a target that counts (2.2)")
    parser.add_argument("--max-incidence-deg", type=positive, help="greatest slant of a target that counts (60)")
    parser.add_argument("--min-targets", type=at_least_one, help="in view, for a camera to be located (2)")
    parser.add_argument("--light", default="indoor", choices=LIGHTS, help="how well dots are seen (indoor)")
    parser.add_argument("--suggest", type=at_least_one, default=0, metavar="N", help="places for the next N targets")
    parser.add_argument("--over", default="worst", choices=OVERS, help="headings that suggestions look at (worst)")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Read, predict, write."""
    compile_first()
    asked = _asked(arguments)
    from app.services.coverage_report.prediction import predict, prediction_file
    from app.services.coverage_report.record import coverage_record

    with progress() as report:
        material = predict(asked, report)
    for path in arguments.out:
        path.write_bytes(prediction_file(asked, material, path.suffix.lower()[1:]))
    record = coverage_record(material, asked.seeing, asked.wish)
    print(json.dumps(record) if arguments.json else "\n".join(_lines(record, arguments.out)))
    return 0


def _asked(arguments: argparse.Namespace) -> Prediction:
    from app.planning.plan_file import Plan, read_plan
    from app.planning.planned_map import planned_map
    from app.planning.predicted_views import Seeing
    from app.planning.suggestions import SuggestionOptions
    from app.services.coverage_report.prediction import Prediction

    path = arguments.plan or arguments.walls
    if arguments.plan is not None and arguments.walls is not None:
        raise InvalidInput("--walls goes with --map; a plan has its own walls")
    plan: Plan | None = None if path is None else read_plan(path)
    wish = _wish(arguments, plan)
    if arguments.map is None:
        assert plan is not None
        target_map, camera = planned_map(replace(plan, view=wish)), plan.camera
    else:
        target_map, camera = _of_map(arguments.map)
    if arguments.camera is not None:
        from app.cli.camera_file import read_camera

        camera = read_camera(arguments.camera)
    return Prediction(
        title=(plan.name if arguments.map is None and plan is not None else arguments.map.stem),
        target_map=target_map,
        walls=plan.walls if plan is not None else (),
        seeing=Seeing(camera, wish.limits, arguments.light),
        wish=wish,
        suggestions=SuggestionOptions(arguments.suggest, arguments.over),
    )


def _of_map(path: Path) -> tuple[Any, CalibratedCamera]:
    """A survey's targets and its first camera, or a typical phone's."""
    from app.geometry.map_file import read_map
    from app.planning.plan_camera import default_camera

    content = read_map(path)
    return content.target_map, content.cameras[0].calibrated if content.cameras else default_camera()


def _wish(arguments: argparse.Namespace, plan: Any) -> ViewWish:
    """The plan's view, with what the command line says instead."""
    from app.planning.plan_view import ViewWish

    wish: ViewWish = ViewWish() if plan is None else plan.view
    names = ("height_m", "step_m", "headings", "pitch_deg", "upright", "clearance_m")
    said = {name: getattr(arguments, name) for name in names if getattr(arguments, name) is not None}
    area_m = wish.area_m if arguments.area_m is None else tuple(arguments.area_m)
    try:
        return replace(wish, **said, area_m=area_m, limits=_limits(arguments, wish.limits))
    except ValueError as error:
        raise InvalidInput(str(error)) from None


def _limits(arguments: argparse.Namespace, limits: SightLimits) -> SightLimits:
    names = ("min_px_per_u", "max_incidence_deg", "min_targets")
    return replace(limits, **{name: getattr(arguments, name) for name in names if getattr(arguments, name) is not None})


def _out(text: str) -> Path:
    path = Path(text)
    if path.suffix.lower() not in SUFFIXES:
        raise argparse.ArgumentTypeError(f"a prediction ends in {', '.join(SUFFIXES)}, not as {text!r}")
    return path


def _lines(record: dict[str, Any], written: list[Path]) -> list[str]:
    """The prediction for people."""
    summary = record["summary"]
    lines = [
        f"{record['title']}: {record['targets']} targets, {summary['positions']} positions at {record['height_m']:g} m"
    ]
    lines += [_summary_line(name, summary[name]) for name in ("best", "middle", "worst")]
    for number, one in enumerate(record["suggestions"], start=1):
        along_m, up_m = one["at_m"]
        lines.append(
            f"next target {number}: wall {one['wall']}, {along_m:.2f} m from its left end and {up_m:.2f} m up "
            f"(code {one['code']}): {_change(one['before'], one['after'])}"
        )
    return [*lines, *(f"written to {path}" for path in written)]


def _summary_line(name: str, summary: dict[str, Any]) -> str:
    share = f"{name + ' heading:':16s} located at {100.0 * summary['located_share']:.0f} % of positions"
    if summary["median_m"] is None:
        return share
    low, middle, high = (f"{MM_PER_M * summary[part]:.1f}" for part in ("p5_m", "median_m", "p95_m"))
    return f"{share}; 95 % radius {middle} mm in the median ({low} to {high} mm)"


def _change(before: dict[str, Any], after: dict[str, Any]) -> str:
    parts = []
    if before["lacking"]:
        parts.append(f"targets lacking in views {before['lacking']} -> {after['lacking']}")
    if after["worst_m"] is not None:
        was = "none" if before["worst_m"] is None else f"{MM_PER_M * before['worst_m']:.1f}"
        parts.append(f"worst radius {was} -> {MM_PER_M * after['worst_m']:.1f} mm")
    return ", ".join(parts)
