"""The report as a document: its sections in the order in which they are read."""

from __future__ import annotations

from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_report.sections.conventions import conventions
from app.services.evaluation_report.sections.figures import distributions, systems
from app.services.evaluation_report.sections.pose_errors import pose_errors
from app.services.evaluation_report.sections.summary import summary
from app.services.evaluation_report.sections.tables import accuracy, comparison, conditions, zones
from app.services.reporting.document import Document
from app.services.reporting.software import this_software


def compose(material: ReportMaterial) -> Document:
    """The document of one or more evaluations against one reference."""
    sections = (
        summary(material),
        *([comparison(material)] if material.differences else []),
        accuracy(material),
        pose_errors(material),
        *([zones(material)] if material.zones else []),
        distributions(material),
        *systems(material),
        conditions(material),
        conventions(),
    )
    return Document(
        title="Evaluation report",
        subject=material.title,
        running_title=material.title,
        producer=this_software(),
        sections=sections,
    )
