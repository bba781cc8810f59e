"""``scattermark simulate``: a plan of a room to photographs of it, control points and the truth."""

from __future__ import annotations

import argparse
import json
import shlex
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, add_workers
from app.cli.progress import progress
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.cli.simulated_room import Rendered
    from app.planning.simulation_plan import Simulation

HELP = "photograph a room that exists only as a plan: photographs, control points, truth"

CODES_SHOWN = 8
USUAL_U_MM, USUAL_FAMILY, MM_PER_M = 14.0, "golay", 1000.0
READABLE_BY_ALL = 0o755  # a temporary folder belongs to its maker alone


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("plan", type=Path, metavar="PLAN.yaml", help="walls, targets, camera and path; see the docs")
    parser.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="where the room goes; not there yet")
    parser.add_argument("--seed", type=seed_number, help="of all that is random (the plan's, or 1)")
    add_workers(parser)
    add_json(parser)


def seed_number(text: str) -> int:
    """A seed for argparse."""
    from app.planning.simulation_plan import GREATEST_SEED

    seed = int(text)
    if not 0 <= seed <= GREATEST_SEED:
        raise argparse.ArgumentTypeError(f"a seed lies between 0 and {GREATEST_SEED}")
    return seed


def run(arguments: argparse.Namespace) -> int:
    """Read, render beside the wished place, move there."""
    from app.planning.simulation_plan import read_simulation

    out = arguments.out
    _check_free(out)
    simulation = read_simulation(arguments.plan, arguments.seed)
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{out.name}-", dir=out.parent) as aside:
        from app.cli.simulated_room import write_room

        whole = Path(aside) / out.name
        whole.mkdir(mode=READABLE_BY_ALL)
        with progress() as report:
            rendered = write_room(simulation, whole, arguments.workers, report)
        (whole / "plan.yaml").write_bytes(arguments.plan.read_bytes())
        _check_free(out)
        whole.rename(out)
    _tell(arguments, simulation, rendered)
    return 0


def _check_free(out: Path) -> None:
    if out.is_dir() and not any(out.iterdir()):
        return
    if out.exists():
        raise InvalidInput(f"{out} is there already; name a new folder, or remove it first")


def _tell(arguments: argparse.Namespace, simulation: Simulation, rendered: Rendered) -> None:
    told: dict[str, Any] = {
        "out": str(arguments.out),
        "seed": simulation.seed,
        "targets": len(simulation.scene.targets),
        "control_points": len(simulation.control),
        "survey": len(rendered.survey),
        "locate": len(rendered.snapshots),
        "seldom_seen": rendered.seldom_seen(simulation),
        "without_target": rendered.without_target(),
        "render_cpu_s": round(rendered.cpu_s, 2),
    }
    if arguments.json:
        print(json.dumps(told))
        return
    photos = f"{told['survey']} photographs to survey and {told['locate']} to locate"
    print(f"{arguments.out}: {photos}, {told['targets']} targets, {told['control_points']} points, seed {told['seed']}")
    each_s = rendered.cpu_s / (told["survey"] + told["locate"])
    print(f"rendered in {each_s:.2f} s of processor time a photograph")
    for words, names in (
        ("targets that fewer than three photographs of the survey show wholly", told["seldom_seen"]),
        ("photographs that show no target wholly", told["without_target"]),
    ):
        if names:
            more = " ..." if len(names) > CODES_SHOWN else ""
            print(f"{len(names)} {words}: {', '.join(map(str, names[:CODES_SHOWN]))}{more}")
    print("next:", *_next_commands(arguments.out, simulation), sep="\n  ")


def _next_commands(out: Path, simulation: Simulation) -> list[str]:
    place, build = shlex.quote(str(out)), ""
    if simulation.plan.family.name != USUAL_FAMILY:
        build += f" --family {simulation.plan.family.name}"
    if simulation.u_m * MM_PER_M != USUAL_U_MM:
        build += f" --u-mm {simulation.u_m * MM_PER_M:g}"
    commands = [f"scattermark build {place}/survey --control {place}/control_points.csv --out map.json{build}"]
    if simulation.snapshots:
        commands += [f"scattermark locate {place}/locate --map map.json"]
    if simulation.snapshots and simulation.plan.family.name == USUAL_FAMILY:
        commands += [f"scattermark demo {place}"]
    return commands
