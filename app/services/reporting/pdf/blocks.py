"""The document's blocks as flowables of the PDF library."""

from __future__ import annotations

from reportlab.platypus import Flowable, KeepTogether, Spacer, TableStyle
from reportlab.platypus import Paragraph as PdfParagraph
from reportlab.platypus import Table as PdfTable

from app.services.reporting.document import (
    Block,
    Facts,
    Figure,
    Finding,
    Findings,
    KeyFigure,
    KeyFigures,
    Paragraph,
    Signatures,
    Table,
)
from app.services.reporting.pdf import look
from app.services.reporting.pdf.drawing import DrawingFlowable
from app.services.reporting.pdf.fonts import BOLD, markup
from app.services.reporting.pdf.tables import table_flowables

FIGURES_A_LINE = 3
NAMES_SHARE = 0.27  # of the width, for the names of facts
GAP = 6.0
SIGNED_LINES = ("Name", "Place and date", "Signature")
SIGNED_HEIGHT = 26.0
LINE_NAME_SHARE = 0.3


def flowables_of(block: Block, width: float) -> list[Flowable]:
    """A block in a frame of a width in points."""
    match block:
        case Paragraph(text):
            return [PdfParagraph(markup(text), look.TEXT)]
        case Facts():
            return [_facts(block, width), Spacer(0, GAP)]
        case KeyFigures():
            return [_key_figures(block, width), Spacer(0, GAP)]
        case Findings(findings):
            return [flowable for finding in findings for flowable in (_finding(finding, width), Spacer(0, GAP / 2))]
        case Table():
            return table_flowables(block, width)
        case Figure(drawing, caption, _):
            return [KeepTogether([DrawingFlowable(drawing), PdfParagraph(markup(caption), look.NOTE)])]
        case Signatures():
            return [KeepTogether([PdfParagraph(markup(block.statement), look.TEXT), _signatures(block, width)])]


def _facts(block: Facts, width: float) -> PdfTable:
    rows = [
        [PdfParagraph(markup(name), look.LABEL), PdfParagraph(markup(text), look.FACT)] for name, text in block.lines
    ]
    names = NAMES_SHARE * width
    return PdfTable(rows, [names, width - names], style=_plain(1.5), hAlign="LEFT")


def _key_figures(block: KeyFigures, width: float) -> PdfTable:
    cards = [_card(figure) for figure in block.figures]
    cards += [[]] * (-len(cards) % FIGURES_A_LINE)
    lines = [cards[start : start + FIGURES_A_LINE] for start in range(0, len(cards), FIGURES_A_LINE)]
    style = TableStyle(
        [
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
            ("BACKGROUND", (0, 0), (-1, -1), look.SHEET),
            ("INNERGRID", (0, 0), (-1, -1), 3.0, "white"),
            ("TOPPADDING", (0, 0), (-1, -1), 6),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 7),
            ("LEFTPADDING", (0, 0), (-1, -1), 9),
        ]
    )
    return PdfTable(lines, [width / FIGURES_A_LINE] * FIGURES_A_LINE, style=style, hAlign="LEFT")


def _card(figure: KeyFigure) -> list[Flowable]:
    lines: list[Flowable] = [
        PdfParagraph(markup(figure.value), look.FIGURE_VALUE),
        PdfParagraph(markup(figure.label), look.FIGURE_LABEL),
    ]
    if figure.detail:
        lines.append(PdfParagraph(markup(figure.detail), look.FIGURE_DETAIL))
    return lines


def _finding(finding: Finding, width: float) -> PdfTable:
    word, ink, sheet = (
        ("Warning", look.GRAVE, look.GRAVE_SHEET) if finding.grave else ("Note", look.INKS["muted"], look.SHEET)
    )
    title = f'<font name="{BOLD}">{word}: {markup(finding.title)}.</font> {markup(finding.text)}'
    style = TableStyle(
        [
            ("BACKGROUND", (0, 0), (-1, -1), sheet),
            ("LINEBEFORE", (0, 0), (0, -1), 2.5, ink),
            ("LEFTPADDING", (0, 0), (-1, -1), 8),
            ("TOPPADDING", (0, 0), (-1, -1), 3),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 5),
        ]
    )
    return PdfTable([[PdfParagraph(title, look.FACT)]], [width], style=style, hAlign="LEFT")


def _signatures(block: Signatures, width: float) -> PdfTable:
    """A column for each role, with room to write."""
    share = width / len(block.roles)
    columns = [[_role(role, share - 2 * GAP)] for role in block.roles]
    return PdfTable([columns], [share] * len(columns), style=_plain(GAP), hAlign="LEFT")


def _role(role: str, width: float) -> PdfTable:
    title = PdfParagraph(markup(role), look.CAPTION)
    lines = [[PdfParagraph(markup(name), look.LABEL), ""] for name in SIGNED_LINES]
    style = TableStyle(
        [
            ("SPAN", (0, 0), (-1, 0)),
            ("VALIGN", (0, 0), (-1, -1), "BOTTOM"),
            ("LINEBELOW", (1, 1), (1, -1), 0.6, look.INKS["ink"]),
            ("LEFTPADDING", (0, 0), (-1, -1), 0),
        ]
    )
    heights = [None, *[SIGNED_HEIGHT] * len(lines)]
    names = LINE_NAME_SHARE * width
    return PdfTable([[title, ""], *lines], [names, width - names], heights, style=style, hAlign="LEFT")


def _plain(padding: float) -> TableStyle:
    return TableStyle(
        [
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
            ("LEFTPADDING", (0, 0), (-1, -1), 0),
            ("TOPPADDING", (0, 0), (-1, -1), padding),
            ("BOTTOMPADDING", (0, 0), (-1, -1), padding),
        ]
    )
