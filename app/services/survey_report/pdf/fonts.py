"""The fonts of the PDF: one family with digits of one width; other characters in viewers' own fonts, or by number."""

from __future__ import annotations

from functools import cache
from importlib.resources import as_file, files
from itertools import groupby
from xml.sax.saxutils import escape

from reportlab.pdfbase.cidfonts import UnicodeCIDFont
from reportlab.pdfbase.pdfmetrics import registerFont, stringWidth
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas

from app.services.survey_report.text import readable

REGULAR, BOLD = "OpenSans-Regular", "OpenSans-Semibold"
# Fonts that PDF viewers bring for scripts which no small font holds, and the character set of each.
ASIAN = (("STSong-Light", "gb2312"), ("HeiseiMin-W3", "shift_jis"), ("HYSMyeongJo-Medium", "euc_kr"))


@cache
def register_fonts() -> frozenset[str]:
    """Make the fonts known to the PDF library, once per process; the characters that the family holds."""
    for name in (REGULAR, BOLD):
        with as_file(files(__package__).joinpath("fonts", f"{name}.ttf")) as path:
            font = TTFont(name, str(path))
        registerFont(font)
    for name, _ in ASIAN:
        registerFont(UnicodeCIDFont(name))
    return frozenset(map(chr, font.face.charToGlyph))


def runs(text: str, font: str = REGULAR) -> list[tuple[str, str]]:
    """A readable text as pieces of one font each: name, piece."""
    held = register_fonts()
    line = readable(text)
    if held.issuperset(line):
        return [(font, line)]
    placed = [_placed(letter, font, held) for letter in line]
    return [(name, "".join(piece for _, piece in group)) for name, group in groupby(placed, key=lambda pair: pair[0])]


def _placed(letter: str, font: str, held: frozenset[str]) -> tuple[str, str]:
    """The font that shows a character, and how; its number when none does."""
    if letter in held:
        return font, letter
    for name, charset in ASIAN:
        try:
            letter.encode(charset)
        except UnicodeEncodeError:
            continue
        return name, letter
    return font, f"[U+{ord(letter):04X}]"


def width_of(text: str, font: str, size: float) -> float:
    """Width of a line, points."""
    return sum(float(stringWidth(piece, name, size)) for name, piece in runs(text, font))


def draw_line(canvas: Canvas, at: tuple[float, float], text: str, font: str, size: float) -> None:
    """Write a line from a point of its baseline."""
    x, y = at
    for name, piece in runs(text, font):
        canvas.setFont(name, size)
        canvas.drawString(x, y, piece)
        x += stringWidth(piece, name, size)


def markup(text: str, font: str = REGULAR) -> str:
    """Text as the library's paragraphs take it: nothing in it is read as markup."""
    pieces = []
    for name, piece in runs(text, font):
        pieces.append(escape(piece) if name == font else f'<font name="{name}">{escape(piece)}</font>')
    return "".join(pieces)
