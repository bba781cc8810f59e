"""What a worker process does for one report: gather, compose, write."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from typing import Literal

from app.services.maps import adjustment_report
from app.services.reporting.html.page import html_of
from app.services.reporting.pdf.file import pdf_of
from app.services.survey_report.compose import compose
from app.services.survey_report.gather import gather
from app.services.survey_report.material import ReportMaterial
from app.services.workbench import workbench

ReportFormat = Literal["html", "json", "pdf"]


@dataclass(frozen=True)
class ReportTask:
    """Which report is wanted; the active version's when none is named."""

    site_id: str
    version: int | None
    format: ReportFormat


@dataclass(frozen=True)
class WrittenReport:
    """A report as the bytes of a file, and the version that it tells of."""

    content: bytes
    map_version: int


def write_report(task: ReportTask) -> WrittenReport:
    """The report of a version.

    Raises
    ------
    NotFound, Conflict
        As ``gather``.
    """
    with workbench().database.reading() as session:
        if task.format == "json":
            record = adjustment_report(session, task.site_id, task.version)
            return WrittenReport(json.dumps(record).encode(), int(record["map_version"]))
        material = gather(session, task.site_id, task.version, time.time())
    assert material.heading.map_version is not None
    return WrittenReport(report_file(material, task.format), material.heading.map_version)


def report_file(material: ReportMaterial, format_name: Literal["html", "pdf"]) -> bytes:
    """The report for people, as the bytes of a file."""
    document = compose(material)
    return pdf_of(document) if format_name == "pdf" else html_of(document).encode()
