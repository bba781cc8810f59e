"""A document as a PDF file: upright pages for reading, broad ones for wide tables, numbered, with an outline."""

from __future__ import annotations

import io
from dataclasses import dataclass

from reportlab.lib.pagesizes import A4, landscape
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import (
    BaseDocTemplate,
    CondPageBreak,
    Flowable,
    Frame,
    HRFlowable,
    NextPageTemplate,
    PageBreak,
    PageTemplate,
    Paragraph,
)

from app.services.reporting.document import Block, Document, Figure, Section, Table
from app.services.reporting.pdf.blocks import flowables_of
from app.services.reporting.pdf.fonts import REGULAR, markup, width_of, written
from app.services.reporting.pdf.look import HEADING, INKS, KICKER, TITLE
from app.services.reporting.pdf.tables import KEPT_ROWS
from app.services.reporting.text import readable

MARGIN = 42.0
HEAD, FOOT = 26.0, 26.0  # baselines of head and foot, from the page's edges
FOOT_SIZE = 7.5
LEAST_ROOM = 120.0  # for a title and what begins below it; else both go to the next page
ROW_ROOM = 16.0  # for a row of a table that stays on one page, now and then of two lines
CAPTION_ROOM = 90.0  # for a title above a figure and the caption below
UPRIGHT, BROAD = "upright", "broad"
TOTAL = "total"
GAP = 2.0
TOTAL_BOX = 24, 8  # points, of "of 123"


@dataclass(frozen=True)
class _Sheet:
    """A kind of page: its size, points."""

    name: str
    size: tuple[float, float]

    @property
    def width(self) -> float:
        """Of what lies between the margins."""
        return self.size[0] - 2 * MARGIN

    def template(self) -> PageTemplate:
        """For the library."""
        width, height = self.size
        room = {"leftPadding": 0, "rightPadding": 0, "topPadding": 0, "bottomPadding": 0}
        frame = Frame(MARGIN, MARGIN, width - 2 * MARGIN, height - 2 * MARGIN, id=self.name, **room)
        return PageTemplate(self.name, [frame], onPage=self.draw_edges, pagesize=self.size)

    def draw_edges(self, canvas: Canvas, file: _File) -> None:
        """Head and foot of a page."""
        width, height = self.size
        canvas.saveState()
        canvas.setFillColor(INKS["muted"])
        canvas.setFont(REGULAR, FOOT_SIZE)
        if file.page > 1:
            canvas.drawString(MARGIN, height - HEAD, _cut(file.document, self.width))
        canvas.drawString(MARGIN, FOOT, written(file.document.producer))
        right = width - MARGIN - TOTAL_BOX[0]
        canvas.drawRightString(right - GAP, FOOT, f"page {file.page}")
        canvas.translate(right, FOOT)
        canvas.doForm(TOTAL)
        canvas.restoreState()


SHEETS = {name: _Sheet(name, size) for name, size in ((UPRIGHT, A4), (BROAD, landscape(A4)))}


class _Title(Paragraph):
    """A section's title, which is also its place in the outline."""

    def __init__(self, text: str, key: str) -> None:
        super().__init__(markup(text), HEADING)
        self._entry = readable(text), key

    def draw(self) -> None:
        """Draw it and remember where."""
        title, key = self._entry
        self.canv.bookmarkHorizontal(key, 0, self.height + HEADING.leading)
        self.canv.addOutlineEntry(title, key, 0)
        super().draw()


class _PageCount(Flowable):
    """Nothing to see: at the end of the document it says how many pages there are, which every foot shows."""

    def wrap(self, _width: float, _height: float) -> tuple[float, float]:
        """No room."""
        return 0.0, 0.0

    def draw(self) -> None:
        """Fill in what the feet refer to."""
        canvas: Canvas = self.canv
        total = f"of {canvas.getPageNumber()}"
        canvas.beginForm(TOTAL, 0, -TOTAL_BOX[1], *TOTAL_BOX)
        canvas.setFillColor(INKS["muted"])
        canvas.setFont(REGULAR, FOOT_SIZE)
        canvas.drawString(0, 0, total)
        canvas.endForm()


class _File(BaseDocTemplate):
    """The library's document with what the pages' edges show."""

    def __init__(self, out: io.BytesIO, document: Document) -> None:
        self.document = document
        super().__init__(
            out,
            pageTemplates=[sheet.template() for sheet in SHEETS.values()],
            title=readable(f"{document.title}: {document.running_title}"),
            author=document.producer,
            creator=document.producer,
            subject=readable(document.subject),
            lang="en",
        )


def pdf_of(document: Document) -> bytes:
    """The document as a PDF file."""
    out = io.BytesIO()
    story: list[Flowable] = [
        Paragraph(markup(document.title), KICKER),
        Paragraph(markup(document.subject), TITLE),
        HRFlowable(width="100%", thickness=2.0, color=INKS["ink"], spaceAfter=4),
    ]
    sheet = SHEETS[UPRIGHT]
    for number, section in enumerate(document.sections):
        wanted = SHEETS[BROAD if section.wide else UPRIGHT]
        if wanted is not sheet:
            story += [NextPageTemplate(wanted.name), PageBreak()]
            sheet = wanted
        story += _section(section, f"part-{number}", sheet.width)
    _File(out, document).build([*story, _PageCount()])
    return out.getvalue()


def _section(section: Section, key: str, width: float) -> list[Flowable]:
    blocks = [flowable for block in section.blocks for flowable in flowables_of(block, width)]
    return [CondPageBreak(_room(section.blocks[0])), _Title(section.title, key), *blocks]


def _room(first: Block) -> float:
    """What a section's title and the block that must follow it on the same page take, points."""
    if isinstance(first, Figure):
        return first.drawing.height + CAPTION_ROOM
    kept = len(first.rows) if isinstance(first, Table) and len(first.rows) <= KEPT_ROWS else 0
    return LEAST_ROOM + kept * ROW_ROOM


def _cut(document: Document, width: float) -> str:
    """The running title, shortened to a line."""
    text = written(f"{document.title}: {document.running_title}")
    while width_of(text, REGULAR, FOOT_SIZE) > width:
        text = f"{text[:-2]}…"
    return text
