"""The report as the bytes of a file."""

from __future__ import annotations

from app.services.evaluation_report.archive import archive_of
from app.services.evaluation_report.compose import compose
from app.services.evaluation_report.material import ReportMaterial
from app.services.reporting.html.page import html_of
from app.services.reporting.pdf.file import pdf_of


def html_report(material: ReportMaterial) -> bytes:
    """One self-contained page: no script, no request to any host."""
    return html_of(compose(material)).encode()


def pdf_report(material: ReportMaterial) -> bytes:
    """For print."""
    return pdf_of(compose(material))


def zip_report(material: ReportMaterial) -> bytes:
    """Both, the numbers as JSON, and what the tool evo reads.

    Notes
    -----
    Of one evaluation the file is itself a result that ``evo_res`` reads; of several it holds one such file each, as
    ``evo/<system>.zip``.
    """
    document = compose(material)
    pages = {"report.html": html_of(document).encode(), "report.pdf": pdf_of(document)}
    return archive_of(material, pages)
