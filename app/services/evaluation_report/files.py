"""The report as the bytes of a file."""

from __future__ import annotations

from app.services.evaluation_report.material import ReportMaterial


def html_report(material: ReportMaterial) -> bytes:
    """One self-contained page."""
    raise NotImplementedError


def pdf_report(material: ReportMaterial) -> bytes:
    """For print."""
    raise NotImplementedError


def zip_report(material: ReportMaterial) -> bytes:
    """Both, and what the tool evo reads."""
    raise NotImplementedError
