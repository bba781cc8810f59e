"""``scattermark build``: photographs and control points to a target map, without the service."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, add_reading, add_workers, photo_files, positive
from app.cli.compile_ import compile_first
from app.cli.progress import progress
from app.cli.report_file import report_path, write_report_file
from app.cli.survey_summary import summary_lines
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.geometry.control import ControlPoint
    from app.geometry.print_batch import PrintBatch

MM_PER_M = 1000.0


HELP = "build a target map from photographs"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("photos", type=Path, nargs="+", help="photographs, or folders of them")
    parser.add_argument("--control", type=Path, metavar="CSV", help="control and check points; none: a free map")
    parser.add_argument(
        "--batches", type=Path, metavar="FILE", help="measured check bars of print batches, CSV or JSON"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="MAP.json", help="where the map goes")
    parser.add_argument("--report", type=report_path, metavar="FILE", help="the report to sign: .html, .pdf or .json")
    parser.add_argument("--site", metavar="NAME", help="the site's name in the report (the map file's)")
    parser.add_argument("--u-mm", type=positive, default=14.0, help="printed module of the plates in mm (14)")
    add_reading(parser)
    add_workers(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect each, adjust, write."""
    compile_first()
    paths = photo_files(arguments.photos)
    from app.cli.detect_file import detect_file
    from app.cli.in_parallel import in_parallel
    from app.geometry.map_file import MapCamera, MapFile, write_map
    from app.photogrammetry.survey import PlateSpec, adjust_survey
    from app.vision.detectors import choose_detector

    detector = choose_detector(arguments.detector, arguments.strictness)
    batches = read_batches(arguments.batches, arguments.family) if arguments.batches else ()
    plate = PlateSpec(arguments.family, arguments.u_mm / MM_PER_M, batches)
    control = read_control(arguments.control, arguments.family) if arguments.control else ()
    with progress() as report:
        photos = in_parallel(detect_file, paths, (arguments.family, detector), arguments.workers, report)
        survey = adjust_survey(photos, control, plate, progress=report)
    cameras = tuple(MapCamera(camera.identity, camera.calibrated) for camera in survey.cameras)
    write_map(arguments.out, MapFile(survey.target_map, cameras))
    if arguments.report is not None:
        write_report_file(arguments.report, survey, arguments.out, arguments.site or arguments.out.stem)
    record = survey.report.to_json()
    if arguments.json:
        print(json.dumps({"map": str(arguments.out), "report": record}))
    else:
        _print(record, arguments.out)
    return 0


def read_control(path: Path, family_name: str) -> tuple[ControlPoint, ...]:
    """Control and check points of a CSV file.

    Raises
    ------
    InvalidControlPoints
        Naming each bad row, or when the points cannot carry a datum.
    """
    from app.services.control_points import check_datum, points_of_records, records_of_csv
    from app.targets.family import family_by_name

    points = points_of_records(records_of_csv(_text_of(path)), family_by_name(family_name))
    check_datum(points)
    return points


def read_batches(path: Path, family_name: str) -> tuple[PrintBatch, ...]:
    """Print batches of a CSV or JSON file.

    Raises
    ------
    InvalidInput
        Naming the batch that cannot be.
    """
    from app.services.print_batches import batches_of_entries, read_entries
    from app.targets.family import family_by_name

    return batches_of_entries(read_entries(_text_of(path)), family_by_name(family_name))


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{path} is no text ({error.reason} at byte {error.start})") from error


def _print(record: dict[str, Any], path: Path) -> None:
    for line in summary_lines(record):
        print(line)
    print(f"map written to {path}")
