"""The fonts of the PDF: one family with digits of one width; a character that it lacks is written by its number."""

from __future__ import annotations

from functools import cache
from importlib.resources import as_file, files
from xml.sax.saxutils import escape

from reportlab.pdfbase.pdfmetrics import registerFont, stringWidth
from reportlab.pdfbase.ttfonts import TTFont

from app.services.reporting.text import readable

REGULAR, BOLD = "OpenSans-Regular", "OpenSans-Semibold"


@cache
def register_fonts() -> frozenset[str]:
    """Make the fonts known to the PDF library, once per process; the characters that both of them hold."""
    held: list[frozenset[str]] = []
    for name in (REGULAR, BOLD):
        with as_file(files(__package__).joinpath("fonts", f"{name}.ttf")) as path:
            font = TTFont(name, str(path))
        registerFont(font)
        held.append(frozenset(map(chr, font.face.charToGlyph)))
    return frozenset.intersection(*held)


def written(text: str) -> str:
    """Text as the PDF writes it: an unknown character is named rather than left out of what is signed."""
    held, line = register_fonts(), readable(text)
    if held.issuperset(line):
        return line
    return "".join(letter if letter in held else f"[U+{ord(letter):04X}]" for letter in line)


def width_of(text: str, font: str, size: float) -> float:
    """Width of a line, points."""
    return float(stringWidth(written(text), font, size))


def markup(text: str) -> str:
    """Text as the library's paragraphs take it: nothing in it is read as markup."""
    return escape(written(text))
