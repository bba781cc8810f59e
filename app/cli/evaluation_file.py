"""An evaluation as a file: the report for people, or the numbers for machines."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.services.evaluation_report.material import ReportMaterial

KINDS = (".html", ".pdf", ".zip", ".json")


def check_kind(path: Path) -> Path:
    """See, before any work, that a file's name says what it is to hold.

    Raises
    ------
    InvalidInput
    """
    if path.suffix.lower() not in KINDS:
        raise InvalidInput(f"--report {path}: end the name with one of {', '.join(KINDS)}")
    return path


def write_evaluation_file(path: Path, material: ReportMaterial, record: Mapping[str, Any]) -> None:
    """Write the report, or the record as JSON, as the name's end says."""
    from app.services.evaluation_report.files import html_report, pdf_report, zip_report

    writers = {".html": html_report, ".pdf": pdf_report, ".zip": zip_report}
    kind = check_kind(path).suffix.lower()
    content = json.dumps(record, indent=2).encode() if kind == ".json" else writers[kind](material)
    path.write_bytes(content)


def titled(reference: str, systems: Sequence[str]) -> str:
    """A report's title."""
    return f"{', '.join(systems)} against {reference}"
