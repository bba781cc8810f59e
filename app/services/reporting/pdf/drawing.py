"""A drawing in the PDF: vectors and text, the sheet's y turned up."""

from __future__ import annotations

from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import Flowable

from app.services.reporting.drawing import Drawing, Ellipse, Label, Path, Pen, Shape
from app.services.reporting.pdf.fonts import REGULAR, width_of, written
from app.services.reporting.pdf.look import INKS

ROUND_JOIN = 1
QUARTER_TURN_DEG = 90.0
SHARE_BEFORE = {"start": 0.0, "middle": 0.5, "end": 1.0}


class DrawingFlowable(Flowable):
    """A drawing in the flow of a page, made smaller where it is too wide."""

    def __init__(self, drawing: Drawing) -> None:
        super().__init__()
        self._drawing = drawing
        self._scale = 1.0

    def wrap(self, width: float, _height: float) -> tuple[float, float]:
        """The room that it takes."""
        self._scale = min(1.0, width / self._drawing.width)
        return self._scale * self._drawing.width, self._scale * self._drawing.height

    def draw(self) -> None:
        """Draw on the flowable's own canvas."""
        canvas: Canvas = self.canv
        canvas.scale(self._scale, self._scale)
        sheet = canvas.beginPath()
        sheet.rect(0, 0, self._drawing.width, self._drawing.height)
        canvas.clipPath(sheet, stroke=0, fill=0)  # a gross residual's arrow ends where the sheet does, as in SVG
        canvas.setLineJoin(ROUND_JOIN)
        for shape in self._drawing.shapes:
            _draw(canvas, shape, self._drawing.height)


def _draw(canvas: Canvas, shape: Shape, height: float) -> None:
    if isinstance(shape, Label):
        _write(canvas, shape, height)
        return
    _take(canvas, shape.pen)
    stroke, fill = int(shape.pen.width > 0), int(shape.pen.filled)
    if isinstance(shape, Ellipse):
        canvas.saveState()
        canvas.translate(float(shape.centre[0]), height - float(shape.centre[1]))
        canvas.rotate(-shape.turn_deg)
        first, second = (float(length) for length in shape.semi_axes)
        canvas.ellipse(-first, -second, first, second, stroke=stroke, fill=fill)
        canvas.restoreState()
        return
    canvas.drawPath(_outline(canvas, shape, height), stroke=stroke, fill=fill)


def _outline(canvas: Canvas, shape: Path, height: float) -> object:
    path = canvas.beginPath()
    for index, (x, y) in enumerate(shape.points.tolist()):
        (path.lineTo if index else path.moveTo)(x, height - y)
    if shape.closed:
        path.close()
    return path


def _take(canvas: Canvas, pen: Pen) -> None:
    canvas.setStrokeColor(INKS[pen.ink])
    canvas.setFillColor(INKS[pen.ink])
    canvas.setLineWidth(pen.width)
    canvas.setDash(list(pen.dash))


def _write(canvas: Canvas, label: Label, height: float) -> None:
    canvas.setFillColor(INKS[label.ink])
    before = SHARE_BEFORE[label.anchor] * width_of(label.text, REGULAR, label.size)
    canvas.saveState()
    canvas.translate(float(label.at[0]), height - float(label.at[1]))
    canvas.rotate(QUARTER_TURN_DEG if label.upwards else 0.0)
    canvas.setFont(REGULAR, label.size)
    canvas.drawString(-before, 0.0, written(label.text))
    canvas.restoreState()
