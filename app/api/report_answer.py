"""The answer that carries a report: its type, its name, and what a browser may do with it."""

from __future__ import annotations

from fastapi import Response

from app.services.report_work import ReportFormat, WrittenReport
from app.services.reporting.html.page import CONTENT_SECURITY_POLICY

MEDIA_TYPES: dict[ReportFormat, str] = {
    "html": "text/html; charset=utf-8",
    "json": "application/json",
    "pdf": "application/pdf",
}
# Pages that are not to be framed cannot be dressed up as another one; nothing that a name holds is ever run.
SECURITY = {
    "Content-Security-Policy": f"{CONTENT_SECURITY_POLICY}; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


def preferred_format(accept: str) -> ReportFormat:
    """The format for an ``Accept`` header when the query names none: a page for browsers, JSON for everybody else."""
    accepted = [part.split(";")[0].strip().lower() for part in accept.split(",")]
    if "text/html" in accepted:
        return "html"
    return "pdf" if "application/pdf" in accepted else "json"


def report_response(site_id: str, report: WrittenReport, format_name: ReportFormat) -> Response:
    """The answer; a browser shows the report and saves it under a name that tells what it is."""
    name = f"scattermark-{site_id}-v{report.map_version}.{format_name}"
    headers = {"Content-Disposition": f'inline; filename="{name}"', "Vary": "Accept", **SECURITY}
    return Response(report.content, media_type=MEDIA_TYPES[format_name], headers=headers)
