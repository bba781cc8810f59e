"""Tables in the PDF: columns as wide as their texts, titles on every page, long names broken into lines."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby
from textwrap import wrap
from typing import Any

from reportlab.lib.styles import ParagraphStyle
from reportlab.platypus import CondPageBreak, Flowable, KeepTogether, Paragraph, TableStyle
from reportlab.platypus import Table as PdfTable

from app.services.reporting.document import Column, Table
from app.services.reporting.pdf.fonts import BOLD, REGULAR, markup, width_of, written
from app.services.reporting.pdf.look import CAPTION, INKS, MARK, NOTE

SIZES = (7.5, 7.0, 6.5, 6.0, 5.5, 5.0, 4.5)
PAD = 3.0
LEADING = 1.3
# The library looks at all the rows that are left on each page: in runs its time stays in proportion to the rows.
RUN_ROWS = 400
KEPT_ROWS = 20  # a table of no more stays on one page
LEAST_ROOM = 80.0  # for a table's title, its head and a few rows; else it begins the next page
LONG_TITLE = 20  # letters of a line above numbers
LEAST_TEXT = 60.0  # a column of names is never narrower, points
STRETCHED_FROM = 0.6  # a table that takes this share of the page's width takes all of it

Command = tuple[Any, ...]


@dataclass(frozen=True)
class Layout:
    """A size of type and the columns' widths, points."""

    size: float
    widths: tuple[float, ...]


def table_flowables(table: Table, available: float) -> list[Flowable]:
    """Title, table, note."""
    layout = lay_out(table, available)
    starts = range(0, max(len(table.rows), 1), RUN_ROWS)
    flowables: list[Flowable] = [Paragraph(markup(table.title), CAPTION)]
    flowables += [_body(_run(table, start), layout) for start in starts]
    if table.note:
        flowables.append(Paragraph(markup(table.note), NOTE))
    return [KeepTogether(flowables)] if len(table.rows) <= KEPT_ROWS else [CondPageBreak(LEAST_ROOM), *flowables]


def _run(table: Table, start: int) -> Table:
    """Some of the rows as a table of their own."""
    end = start + RUN_ROWS
    marked = frozenset(row - start for row in table.marked if start <= row < end)
    return replace(table, rows=table.rows[start:end], marked=marked)


def _body(table: Table, layout: Layout) -> PdfTable:
    head = _head(table.columns)
    rows = [_cells(row, table.columns, layout) for row in table.rows]
    style = [*_rules(table, len(head)), *_groups(table.columns, len(head)), *_type(table, layout, len(head))]
    return PdfTable([*head, *rows], layout.widths, style=TableStyle(style), repeatRows=len(head), hAlign="LEFT")


def lay_out(table: Table, available: float) -> Layout:
    """The greatest type with which all columns fit, names broken into lines where they must."""
    for size in SIZES:
        natural = _natural_widths(table, size)
        least = [
            min(width, LEAST_TEXT) if column.align == "left" else width
            for width, column in zip(natural, table.columns, strict=True)
        ]
        if sum(least) <= available:
            return Layout(size, _shared(natural, least, available))
    return Layout(SIZES[-1], tuple(width * available / sum(least) for width in least))


def _natural_widths(table: Table, size: float) -> list[float]:
    """Widths in which no text is broken. Digits are all of one width, so the longest number is the widest."""
    widths = []
    for index, column in enumerate(table.columns):
        texts = [row[index] for row in table.rows]
        if column.align == "right":
            texts = [max(texts, key=len)] if texts else []
        widest = max((width_of(text, REGULAR, size) for text in texts), default=0.0)
        title = max(width_of(line, BOLD, size) for line in _lines(column))
        widths.append(2 * PAD + max(widest, title))
    return [max(width, share) for width, share in zip(widths, _group_shares(table.columns, size), strict=True)]


def _group_shares(columns: tuple[Column, ...], size: float) -> list[float]:
    """What each column must give to its group's title."""
    shares: list[float] = []
    for group, members in groupby(columns, key=lambda column: column.group):
        count = len(list(members))
        shares += [(2 * PAD + width_of(group, BOLD, size)) / count if group else 0.0] * count
    return shares


def _shared(natural: list[float], least: list[float], available: float) -> tuple[float, ...]:
    """Widths between the least and the natural ones; a wide table is stretched to the page."""
    wanted, needed = sum(natural), sum(least)
    if wanted <= available:
        stretch = available / wanted if wanted > STRETCHED_FROM * available else 1.0
        return tuple(width * stretch for width in natural)
    given = (available - needed) / (wanted - needed)
    return tuple(low + given * (width - low) for width, low in zip(natural, least, strict=True))


def _head(columns: tuple[Column, ...]) -> list[list[str]]:
    """Titles of groups, when there are any, above those of columns."""
    titles = ["\n".join(map(written, _lines(column))) for column in columns]
    groups: list[str] = []
    for group, members in groupby(columns, key=lambda column: column.group):
        groups += [group] + [""] * (len(list(members)) - 1)
    return [groups, titles] if any(groups) else [titles]


def _lines(column: Column) -> list[str]:
    """A title in lines, which is longer than its numbers where they are of a system with a long name."""
    if column.align == "left" or len(column.title) <= LONG_TITLE:
        return [column.title]
    return wrap(column.title, LONG_TITLE) or [column.title]


def _cells(row: tuple[str, ...], columns: tuple[Column, ...], layout: Layout) -> list[str | Paragraph]:
    return [
        _text_cell(text, width, layout.size) if column.align == "left" else written(text)
        for text, column, width in zip(row, columns, layout.widths, strict=True)
    ]


def _text_cell(text: str, width: float, size: float) -> str | Paragraph:
    """A plain string, which the library writes as it is, or a paragraph when it takes more than a line."""
    if width_of(text, REGULAR, size) <= width - 2 * PAD:
        return written(text)
    style = ParagraphStyle("cell", fontName=REGULAR, fontSize=size, leading=LEADING * size, textColor=INKS["ink"])
    return Paragraph(markup(text), style)


def _rules(table: Table, head: int) -> list[Command]:
    marked = [("BACKGROUND", (0, head + row), (-1, head + row), MARK) for row in sorted(table.marked)]
    return [
        *marked,
        ("LINEABOVE", (0, 0), (-1, 0), 1.0, INKS["ink"]),
        ("LINEBELOW", (0, head - 1), (-1, head - 1), 0.6, INKS["muted"]),
        ("LINEBELOW", (0, head), (-1, -1), 0.3, INKS["grid"]),
        ("LINEBELOW", (0, "splitlast"), (-1, "splitlast"), 1.0, INKS["ink"]),
        ("LINEBELOW", (0, -1), (-1, -1), 1.0, INKS["ink"]),
    ]


def _groups(columns: tuple[Column, ...], head: int) -> list[Command]:
    """Titles of groups centred over their columns, a line below."""
    commands: list[Command] = []
    first = 0
    for group, members in groupby(columns, key=lambda column: column.group):
        last = first + len(list(members)) - 1
        if group and head > 1:
            commands += [("SPAN", (first, 0), (last, 0)), ("ALIGN", (first, 0), (last, 0), "CENTER")]
            commands.append(("LINEBELOW", (first, 0), (last, 0), 0.4, INKS["grid"]))
        first = last + 1
    return commands


def _type(table: Table, layout: Layout, head: int) -> list[Command]:
    aligned = [
        ("ALIGN", (index, head - 1), (index, -1), column.align.upper()) for index, column in enumerate(table.columns)
    ]
    return [
        *aligned,
        ("FONT", (0, 0), (-1, head - 1), BOLD, layout.size, LEADING * layout.size),
        ("FONT", (0, head), (-1, -1), REGULAR, layout.size, LEADING * layout.size),
        ("TEXTCOLOR", (0, 0), (-1, -1), INKS["ink"]),
        ("VALIGN", (0, 0), (-1, head - 1), "BOTTOM"),
        ("VALIGN", (0, head), (-1, -1), "TOP"),
        ("LEFTPADDING", (0, 0), (-1, -1), PAD),
        ("RIGHTPADDING", (0, 0), (-1, -1), PAD),
        ("TOPPADDING", (0, 0), (-1, -1), 0.7),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1.3),
    ]
