"""A drawing as a file of its own: SVG with its colours inside, or PNG."""

from __future__ import annotations

import io

import pypdfium2
from reportlab.pdfgen.canvas import Canvas

from app.services.reporting.drawing import Drawing
from app.services.reporting.html.svg import svg_of
from app.services.reporting.pdf.drawing import DrawingFlowable
from app.services.reporting.pdf.look import INKS

PX_PER_POINT = 2.0  # of a PNG: 144 dpi
STYLE = "text{font-family:Helvetica,Arial,sans-serif;stroke:none}path,ellipse{fill:none;stroke:none}"


def svg_file(drawing: Drawing, description: str) -> bytes:
    """The drawing as an SVG file on white."""
    inks = "".join(
        f".f-{ink}{{fill:#{colour.hexval()[2:]}}}.s-{ink}{{stroke:#{colour.hexval()[2:]}}}"
        for ink, colour in INKS.items()
    )
    sheet = f'<rect width="{drawing.width:.6g}" height="{drawing.height:.6g}" fill="#ffffff"/>'
    root, rest = svg_of(drawing, description).split(">", 1)
    root = root.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)
    # A selector of one class outweighs those of elements above.
    return f"{root}><style>{STYLE}{inks}</style>{sheet}{rest}\n".encode()


def png_file(drawing: Drawing) -> bytes:
    """The drawing as a PNG file on white."""
    pdf = io.BytesIO()
    canvas = Canvas(pdf, pagesize=(drawing.width, drawing.height))
    flowable = DrawingFlowable(drawing)
    flowable.wrap(drawing.width, drawing.height)
    flowable.drawOn(canvas, 0, 0)
    canvas.showPage()
    canvas.save()
    document = pypdfium2.PdfDocument(pdf.getvalue())
    try:
        picture = document[0].render(scale=PX_PER_POINT).to_pil()
    finally:
        document.close()
    png = io.BytesIO()
    picture.save(png, "PNG", optimize=True)
    return png.getvalue()
