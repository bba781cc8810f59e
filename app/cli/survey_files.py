"""The files that surveys are made of on the command line: photographs looked at, control points, print batches."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.progress import Report
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.geometry.control import ControlPoint
    from app.geometry.print_batch import PrintBatch
    from app.photogrammetry.survey_input import SurveyPhoto

MM_PER_M = 1000.0


def detect_all(arguments: argparse.Namespace, paths: Sequence[Path], report: Report) -> list[SurveyPhoto]:
    """What each photograph shows, read as ``add_survey``'s arguments say."""
    from app.cli.detect_file import detect_file
    from app.cli.in_parallel import in_parallel
    from app.vision.detectors import choose_detector

    detector = choose_detector(arguments.detector, arguments.strictness)
    return in_parallel(detect_file, paths, (arguments.family, detector), arguments.workers, report)


def control_of(arguments: argparse.Namespace) -> tuple[ControlPoint, ...]:
    """Control and check points of ``--control``; none without it."""
    return read_control(arguments.control, arguments.family) if arguments.control else ()


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
