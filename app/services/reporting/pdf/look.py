"""How the PDF looks: colours, sizes, paragraph styles."""

from __future__ import annotations

from reportlab.lib.colors import Color, HexColor
from reportlab.lib.styles import ParagraphStyle

from app.services.reporting.drawing import Ink
from app.services.reporting.pdf.fonts import BOLD, REGULAR

# The light colours of the page's style.
INKS: dict[Ink, Color] = {
    "ink": HexColor("#1b1f24"),
    "muted": HexColor("#56606b"),
    "grid": HexColor("#d3d9df"),
    "target": HexColor("#1f5fa8"),
    "photo": HexColor("#6b4aa5"),
    "control": HexColor("#b3261e"),
    "check": HexColor("#0a6e44"),
    "error": HexColor("#a84e00"),
    "band": HexColor("#dde4ea"),
    "series1": HexColor("#00529b"),
    "series2": HexColor("#cf5a00"),
    "series3": HexColor("#00906a"),
    "series4": HexColor("#8c2a6e"),
    "series5": HexColor("#8b8f96"),
    "series6": HexColor("#101418"),
    "size1": HexColor("#d47d0e"),
    "size2": HexColor("#d2502c"),
    "size3": HexColor("#a12a62"),
    "size4": HexColor("#661a6b"),
    "size5": HexColor("#22084a"),
}
SHEET, GRAVE, GRAVE_SHEET, MARK = (HexColor(code) for code in ("#f4f6f8", "#8f1d16", "#fdf0ee", "#fff3d6"))


LEADING = 1.35


def _style(size: float, font: str = REGULAR, ink: Ink = "ink", space: tuple[float, float] = (0, 0)) -> ParagraphStyle:
    """A style with its space before and after; leading grows with the size."""
    return ParagraphStyle(
        f"{font} {size} {ink}",
        fontName=font,
        fontSize=size,
        leading=LEADING * size,
        textColor=INKS[ink],
        spaceBefore=space[0],
        spaceAfter=space[1],
    )


TEXT = _style(8.5, space=(0, 4))
KICKER = _style(8, ink="muted")
TITLE = _style(20, BOLD, space=(0, 6))
HEADING = _style(13, BOLD, space=(14, 6))
CAPTION = _style(9.5, BOLD, space=(8, 3))
NOTE = _style(7.5, ink="muted", space=(2, 8))
LABEL = _style(8, ink="muted")
FACT = _style(8)
FIGURE_VALUE = _style(15, BOLD)
FIGURE_LABEL = _style(8)
FIGURE_DETAIL = _style(6.8, ink="muted")
