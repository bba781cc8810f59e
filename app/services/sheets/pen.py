"""Drawing in the sheet's millimetres, y down, on the PDF library's canvas, which counts in points, y up."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from reportlab.lib.colors import Color
from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from app.services.reporting.pdf.fonts import REGULAR, width_of, written
from app.targets.paper import Paper

MAX_8_BIT = 255
QUARTER_TURN_DEG = 90.0

Rgb = tuple[int, int, int]
Box = tuple[float, float, float, float]  # top left corner, width, height; mm


@dataclass(frozen=True)
class Writing:
    """How a text looks: size, font, colour, and on which side of its point it stands."""

    size_mm: float
    rgb: Rgb
    font: str = REGULAR
    anchor: float = 0.0  # share of the text's width before the point
    upwards: bool = False


class Pen:
    """Draws on the present page of a canvas.

    Parameters
    ----------
    canvas : Canvas
    paper : Paper
        The page.
    """

    def __init__(self, canvas: Canvas, paper: Paper) -> None:
        self._canvas = canvas
        self._height_mm = paper.height_mm

    def rectangle(self, box_mm: Box, rgb: Rgb) -> None:
        """Fill a rectangle."""
        self.rectangles([box_mm], rgb)

    def rectangles(self, boxes_mm: Iterable[Box], rgb: Rgb) -> None:
        """Fill many rectangles at once."""
        path = self._canvas.beginPath()
        for x_mm, y_mm, width_mm, height_mm in boxes_mm:
            path.rect(x_mm * mm, self._up(y_mm + height_mm), width_mm * mm, height_mm * mm)
        self._canvas.setFillColor(_colour(rgb))
        self._canvas.drawPath(path, stroke=0, fill=1)

    def disc(self, centre_mm: tuple[float, float], radius_mm: float, rgb: Rgb) -> None:
        """Fill a circle."""
        self._canvas.setFillColor(_colour(rgb))
        self._canvas.circle(centre_mm[0] * mm, self._up(centre_mm[1]), radius_mm * mm, stroke=0, fill=1)

    def line(self, from_mm: tuple[float, float], to_mm: tuple[float, float], width_mm: float, rgb: Rgb) -> None:
        """Draw a straight line with butt ends."""
        self._canvas.setStrokeColor(_colour(rgb))
        self._canvas.setLineWidth(width_mm * mm)
        self._canvas.line(from_mm[0] * mm, self._up(from_mm[1]), to_mm[0] * mm, self._up(to_mm[1]))

    def polygon(self, corners_mm: tuple[tuple[float, float], ...], rgb: Rgb) -> None:
        """Fill a polygon."""
        path = self._canvas.beginPath()
        for index, (x_mm, y_mm) in enumerate(corners_mm):
            (path.lineTo if index else path.moveTo)(x_mm * mm, self._up(y_mm))
        path.close()
        self._canvas.setFillColor(_colour(rgb))
        self._canvas.drawPath(path, stroke=0, fill=1)

    def text(self, at_mm: tuple[float, float], text: str, writing: Writing) -> None:
        """Write a line; the point stands on its baseline."""
        size = writing.size_mm * mm
        self._canvas.saveState()
        self._canvas.translate(at_mm[0] * mm, self._up(at_mm[1]))
        self._canvas.rotate(QUARTER_TURN_DEG if writing.upwards else 0.0)
        self._canvas.setFillColor(_colour(writing.rgb))
        self._canvas.setFont(writing.font, size)
        self._canvas.drawString(-writing.anchor * width_of(text, writing.font, size), 0.0, written(text))
        self._canvas.restoreState()

    def _up(self, y_mm: float) -> float:
        return (self._height_mm - y_mm) * mm


def width_mm_of(text: str, writing: Writing) -> float:
    """Width of a line."""
    return width_of(text, writing.font, writing.size_mm * mm) / mm


def _colour(rgb: Rgb) -> Color:
    return Color(*(value / MAX_8_BIT for value in rgb))
