"""The report as a document: its sections in the order in which they are read."""

from __future__ import annotations

from app.services.reporting.document import Document
from app.services.survey_report.material import ReportMaterial
from app.services.survey_report.sections.adjustment import adjustment, plan
from app.services.survey_report.sections.cameras import cameras
from app.services.survey_report.sections.findings import findings
from app.services.survey_report.sections.photographs import photographs
from app.services.survey_report.sections.points import points
from app.services.survey_report.sections.signature import conventions, signature
from app.services.survey_report.sections.summary import summary
from app.services.survey_report.sections.targets import targets


def compose(material: ReportMaterial) -> Document:
    """The document of a survey."""
    heading = material.heading
    version = "" if heading.map_version is None else f", map version {heading.map_version}"
    sections = (
        summary(material),
        findings(material),
        points(material),
        plan(material),
        adjustment(material),
        *cameras(material),
        photographs(material),
        targets(material),
        conventions(),
        signature(material),
    )
    return Document(
        title="Survey report",
        subject=heading.site_name,
        running_title=f"{heading.site_name}{version}",
        producer=heading.software,
        sections=sections,
    )
