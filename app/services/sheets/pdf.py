"""Sheets as a PDF of vectors, exact in millimetres."""

from __future__ import annotations

import io

from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from app.services.reporting.pdf.fonts import register_fonts
from app.services.reporting.software import this_software
from app.services.sheets.page import draw_sheet
from app.services.sheets.pen import Pen
from app.services.sheets.wish import SheetsPlan


def pdf_of_sheets(plan: SheetsPlan) -> bytes:
    """The sheets of a plan, a page each; a print dialogue is told not to fit them to the page."""
    register_fonts()
    out = io.BytesIO()
    paper = plan.layout.paper
    canvas = Canvas(out, pagesize=(paper.width_mm * mm, paper.height_mm * mm), pageCompression=1, invariant=1)
    canvas.setTitle(f"Scattermark targets: {plan.title}" if plan.title else "Scattermark targets")
    canvas.setCreator(this_software())
    canvas.setViewerPreference("PrintScaling", "None")
    for number in range(len(plan.sheets)):
        draw_sheet(Pen(canvas, paper), plan, number)
        canvas.showPage()
    canvas.save()
    return out.getvalue()
