"""``scattermark build``: photographs and control points to a target map, without the service."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from app.cli.arguments import add_json, add_survey, photo_files
from app.cli.compile_ import compile_first
from app.cli.progress import progress
from app.cli.report_file import report_path, write_report_file
from app.cli.survey_files import MM_PER_M, control_of, detect_all, read_batches
from app.cli.survey_summary import summary_lines

HELP = "build a target map from photographs"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    add_survey(parser, control="control and check points; none: a free map")
    parser.add_argument(
        "--batches", type=Path, metavar="FILE", help="measured check bars of print batches, CSV or JSON"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="MAP.json", help="where the map goes")
    parser.add_argument("--report", type=report_path, metavar="FILE", help="the report to sign: .html, .pdf or .json")
    parser.add_argument("--site", metavar="NAME", help="the site's name in the report (the map file's)")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect each, adjust, write."""
    compile_first()
    paths = photo_files(arguments.photos)
    from app.geometry.map_file import MapCamera, MapFile, write_map
    from app.photogrammetry.survey import PlateSpec, adjust_survey

    batches = read_batches(arguments.batches, arguments.family) if arguments.batches else ()
    plate = PlateSpec(arguments.family, arguments.u_mm / MM_PER_M, batches)
    control = control_of(arguments)
    with progress() as report:
        photos = detect_all(arguments, paths, report)
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


def _print(record: dict[str, Any], path: Path) -> None:
    for line in summary_lines(record):
        print(line)
    print(f"map written to {path}")
