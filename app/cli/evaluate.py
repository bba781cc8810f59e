"""``scattermark evaluate``: systems under test beside a reference, from files."""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, positive
from app.cli.evaluation_choices import add_choices, options_of
from app.cli.evaluation_file import check_kind, titled, write_evaluation_file
from app.cli.evaluation_input import InputFile, add_input, read_input
from app.errors import DegenerateGeometry, InvalidInput

if TYPE_CHECKING:
    from app.trajectories.comparison import Difference
    from app.trajectories.evaluation import Evaluation, EvaluationOptions

HELP = "compare trajectories of systems under test with a reference"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input(parser)
    add_choices(parser)
    parser.add_argument(
        "--bands-m", type=positive, nargs="+", default=[], help="count errors along each axis below, between and above"
    )
    parser.add_argument("--report", type=Path, metavar="FILE", help="write a report too: .html, .pdf, .zip or .json")
    add_json(parser)


@dataclass(frozen=True)
class _Compared:
    """All that came out: the files that were read, the evaluations by system, the paired differences."""

    files: tuple[InputFile, ...]
    evaluations: dict[str, Evaluation]
    differences: tuple[Difference, ...]


def run(arguments: argparse.Namespace) -> int:
    """Evaluate and print."""
    if arguments.report is not None:
        check_kind(arguments.report)
    options = options_of(arguments)
    compared = _compared(arguments, options)
    record = _record(compared, arguments.bands_m)
    if arguments.report is not None:
        _write_report(arguments, compared, options, record)
    if arguments.json:
        print(json.dumps(record))
        return 0
    from app.cli.evaluation_table import print_evaluations

    for file in compared.files:
        print(file.sentence)
    print_evaluations(compared.evaluations, compared.differences, arguments.bands_m)
    return 0


def _compared(arguments: argparse.Namespace, options: EvaluationOptions) -> _Compared:
    from app.trajectories.comparison import compare

    systems = _named(arguments.estimate)
    reference = read_input(arguments.reference, arguments)
    files = {name: read_input(path, arguments) for name, path in systems.items()}
    evaluations = {name: _evaluated(reference, file, options) for name, file in files.items()}
    differences = compare(evaluations, options.association.max_gap_s, options.bootstrap)
    return _Compared((reference, *files.values()), evaluations, differences)


def _evaluated(reference: InputFile, file: InputFile, options: EvaluationOptions) -> Evaluation:
    from app.trajectories.evaluation import evaluate

    try:
        return evaluate(reference.trajectory, file.trajectory, options)
    except (InvalidInput, DegenerateGeometry) as error:
        raise type(error)(f"{file.path}: {error.detail}", **error.fields) from error


def _write_report(
    arguments: argparse.Namespace, compared: _Compared, options: EvaluationOptions, record: dict[str, Any]
) -> None:
    from app.services.evaluation_report.material import ReportMaterial

    name, evaluations = arguments.reference.stem, compared.evaluations
    title = titled(name, tuple(evaluations))
    material = ReportMaterial(title, name, evaluations, compared.differences, options.zones)
    write_evaluation_file(arguments.report, material, record)


def _named(paths: list[Path]) -> dict[str, Path]:
    """Files by their names, or by their whole paths where two have one name."""
    if len(set(paths)) < len(paths):
        raise InvalidInput("a file is named twice; name each system once")
    stems = [path.stem for path in paths]
    return {path.stem if stems.count(path.stem) == 1 else str(path): path for path in paths}


def _record(compared: _Compared, bands_m: list[float]) -> dict[str, Any]:
    from app.trajectories.evaluation_record import record_of_difference, record_of_evaluation
    from app.trajectories.metrics.bands import counts_in_bands

    evaluations = compared.evaluations
    counts = {
        name: counts_in_bands(evaluation.errors, bands_m).tolist()
        for name, evaluation in evaluations.items()
        if bands_m
    }
    return {
        "files": [
            {
                "path": str(file.path),
                "format": file.format,
                "poses": len(file.trajectory),
                "time_unit": file.time_unit,
                "note": file.note,
            }
            for file in compared.files
        ],
        "bands_m": bands_m,
        "counts_in_bands": counts,
        "evaluations": {name: record_of_evaluation(evaluation) for name, evaluation in evaluations.items()},
        "differences": [record_of_difference(difference) for difference in compared.differences],
    }
