"""``scattermark evaluate``: systems under test beside a reference, from files."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, positive
from app.cli.evaluation_file import check_kind, titled, write_evaluation_file
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.trajectories.evaluation import Evaluation, EvaluationOptions
    from app.trajectories.trajectory import Trajectory

HELP = "compare trajectories of systems under test with a reference"

# Tests hold these equal to the library's lists, whose import is slow.
FORMATS = ("csv", "tum", "euroc", "evaal")
UNITS = ("s", "ms", "us", "ns")
ASSOCIATIONS = ("interpolate", "nearest", "last")
ALIGNMENTS = ("none", "se3", "posyaw", "sim3", "origin", "first_n")
ESTIMATED = "estimate"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("reference", type=Path, help="trajectory that is true")
    parser.add_argument("estimate", type=Path, nargs="+", help="trajectories of systems, or of runs of one")
    parser.add_argument("--format", choices=FORMATS, help="of all files (seen in each file's first line)")
    parser.add_argument("--time-unit", choices=UNITS, help="of all stamps (seen in the stamps)")
    parser.add_argument(
        "--association",
        choices=ASSOCIATIONS,
        default="interpolate",
        help="how poses are paired: the reference interpolated, the nearest, or EvAAL's last word (interpolate)",
    )
    parser.add_argument("--max-gap-s", type=positive, help="largest gap in time (1)")
    parser.add_argument("--alignment", choices=ALIGNMENTS, default="none", help="into the reference's frame (none)")
    parser.add_argument(
        "--time-offset-s", type=_offset, default=0.0, help="reference's clock less the estimate's, or `estimate` (0)"
    )
    parser.add_argument("--lever-arm-m", type=float, nargs=3, metavar=("X", "Y", "Z"), help="camera to antenna")
    parser.add_argument("--floor-height-m", type=positive, help="height of a storey, where storeys are told by z")
    parser.add_argument(
        "--bands-m", type=positive, nargs="+", default=[], help="count errors along each axis below, between and above"
    )
    parser.add_argument("--report", type=Path, metavar="FILE", help="write a report too: .html, .pdf, .zip or .json")
    add_json(parser)


def _offset(text: str) -> float | None:
    if text == ESTIMATED:
        return None
    try:
        return float(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"seconds, or `{ESTIMATED}`, and not {text!r}") from error


def run(arguments: argparse.Namespace) -> int:
    """Evaluate and print."""
    from app.trajectories.comparison import compare
    from app.trajectories.evaluation import evaluate

    if arguments.report is not None:
        check_kind(arguments.report)
    options = _options(arguments)
    reference = _read(arguments.reference, arguments)
    evaluations: dict[str, Evaluation] = {
        name: evaluate(reference, _read(path, arguments), options) for name, path in _named(arguments.estimate).items()
    }
    differences = compare(evaluations, options.association.max_gap_s, options.bootstrap)
    if arguments.report is not None:
        _write_report(arguments, evaluations, differences)
    if arguments.json:
        print(json.dumps(_record(evaluations, differences, arguments.bands_m)))
        return 0
    from app.cli.evaluation_table import print_evaluations

    print_evaluations(evaluations, differences, arguments.bands_m)
    return 0


def _write_report(
    arguments: argparse.Namespace, evaluations: dict[str, Evaluation], differences: tuple[Any, ...]
) -> None:
    from app.services.evaluation_report.material import ReportMaterial

    name = arguments.reference.stem
    material = ReportMaterial(titled(name, tuple(evaluations)), name, evaluations, differences)
    record = _record(evaluations, differences, arguments.bands_m)
    write_evaluation_file(arguments.report, material, record)


def _named(paths: list[Path]) -> dict[str, Path]:
    """Files by their names, or by their whole paths where two have one name."""
    if len(set(paths)) < len(paths):
        raise InvalidInput("a file is named twice; name each system once")
    stems = [path.stem for path in paths]
    return {path.stem if stems.count(path.stem) == 1 else str(path): path for path in paths}


def _options(arguments: argparse.Namespace) -> EvaluationOptions:
    import numpy as np

    from app.trajectories.alignment import AlignmentOptions
    from app.trajectories.association import AssociationOptions
    from app.trajectories.evaluation import EvaluationOptions

    gap = {} if arguments.max_gap_s is None else {"max_gap_s": arguments.max_gap_s}
    return EvaluationOptions(
        association=AssociationOptions(arguments.association, **gap),
        alignment=AlignmentOptions(arguments.alignment),
        time_offset_s=arguments.time_offset_s,
        lever_arm_m=None if arguments.lever_arm_m is None else np.array(arguments.lever_arm_m),
        floor_height_m=arguments.floor_height_m,
    )


def _read(path: Path, arguments: argparse.Namespace) -> Trajectory:
    from app.trajectories.reading.any_file import read_trajectory

    try:
        return read_trajectory(path.read_bytes(), arguments.format, arguments.time_unit).trajectory
    except InvalidInput as error:
        raise type(error)(f"{path}: {error.detail}", **error.fields) from error


def _record(evaluations: dict[str, Any], differences: tuple[Any, ...], bands_m: list[float]) -> dict[str, Any]:
    from app.trajectories.evaluation_record import record_of_difference, record_of_evaluation
    from app.trajectories.metrics.bands import counts_in_bands

    counts = {
        name: counts_in_bands(evaluation.errors, bands_m).tolist()
        for name, evaluation in evaluations.items()
        if bands_m
    }
    return {
        "bands_m": bands_m,
        "counts_in_bands": counts,
        "evaluations": {name: record_of_evaluation(evaluation) for name, evaluation in evaluations.items()},
        "differences": [record_of_difference(difference) for difference in differences],
    }
