"""The report of ``scattermark build``, in the format that its file's name asks for."""

from __future__ import annotations

import argparse
import json
import time
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.photogrammetry.survey import SurveyResult

SUFFIXES = (".html", ".json", ".pdf")


def report_path(text: str) -> Path:
    """A report's file for argparse: its suffix is known before anything is computed."""
    path = Path(text)
    if path.suffix.lower() not in SUFFIXES:
        raise argparse.ArgumentTypeError(f"a report ends in {', '.join(SUFFIXES)}, not as {text!r}")
    return path


def write_report_file(path: Path, survey: SurveyResult, map_path: Path, site_name: str) -> None:
    """Write the report of a survey whose map has been written."""
    if path.suffix.lower() == ".json":
        path.write_text(json.dumps(survey.report.to_json(), indent=1))
        return
    from app.services.photo_results import photo_results
    from app.services.report_work import report_file
    from app.services.reporting.software import this_software
    from app.services.survey_report.material import Fingerprint, Heading, ReportMaterial

    now_s = time.time()
    heading = Heading(
        site_name=site_name,
        site_id=None,
        survey_id=None,
        map_version=None,
        survey_note="",
        built_s=now_s,
        written_s=now_s,
        software=this_software(),
        fingerprint=Fingerprint(map_path.name, sha256(map_path.read_bytes()).hexdigest()),
    )
    material = ReportMaterial(heading, survey.report, survey.target_map, photo_results(survey))
    path.write_bytes(report_file(material, "pdf" if path.suffix.lower() == ".pdf" else "html"))
