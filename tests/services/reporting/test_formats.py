"""What drawings can be, both formats show: dashes, and text that reads upwards."""

from __future__ import annotations

import io

import numpy as np
from pypdf import PdfReader

from app.services.reporting.document import Document, Figure, Section
from app.services.reporting.drawing import Drawing, Label, Pen, line
from app.services.reporting.html.svg import svg_of
from app.services.reporting.pdf.file import pdf_of

SHAPES = (
    line(np.zeros(2), np.array([50.0, 0.0]), Pen("series2", 1.0, dash=(4.0, 1.5))),
    line(np.zeros(2), np.array([0.0, 50.0]), Pen("series1", 1.0)),
    Label(np.array([12.0, 60.0]), "height, m", upwards=True),
)
DRAWING = Drawing(100.0, 80.0, SHAPES)


def test_svg_shows_dashes_and_turned_text() -> None:
    svg = svg_of(DRAWING, "two lines and a title")
    assert svg.count("stroke-dasharray") == 1 and 'stroke-dasharray="4 1.5"' in svg
    assert 'transform="rotate(-90 12.00 60.00)"' in svg


def test_pdf_shows_dashes_and_turned_text() -> None:
    figure = Figure(DRAWING, "caption", "two lines and a title")
    document = Document("Report", "sample", "sample", "test", (Section("Sample", (figure,)),))
    (page,) = PdfReader(io.BytesIO(pdf_of(document))).pages
    assert "height, m" in page.extract_text()
    content = page.get_contents()
    assert content is not None
    drawn = content.get_data().decode("latin-1")
    assert "[4 1.5] 0 d" in drawn and "[] 0 d" in drawn  # the second line is whole again
    assert "0 1 -1 0 12 20 cm" in drawn  # a quarter turn to the left
