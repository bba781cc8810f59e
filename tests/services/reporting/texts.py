"""All that a document says, as it says it."""

from __future__ import annotations

from collections.abc import Iterator

from app.services.reporting.document import (
    Block,
    Document,
    Facts,
    Figure,
    Findings,
    KeyFigures,
    Paragraph,
    Section,
    Signatures,
    Table,
)
from app.services.reporting.drawing import Label


def texts_of(document: Document) -> Iterator[str]:
    """Titles, running text, cells, captions and labels of drawings."""
    yield from (document.title, document.subject, document.producer)
    for section in document.sections:
        yield section.title
        for block in section.blocks:
            yield from texts_of_block(block)


def texts_of_block(block: Block) -> Iterator[str]:
    match block:
        case Paragraph(text):
            yield text
        case Facts(lines):
            yield from (text for line in lines for text in line)
        case KeyFigures(figures):
            yield from (text for figure in figures for text in (figure.value, figure.label, figure.detail))
        case Findings(findings):
            yield from (text for finding in findings for text in (finding.title, finding.text))
        case Table():
            yield from (block.title, block.note, *(column.title for column in block.columns))
            yield from (text for row in block.rows for text in row)
        case Figure(drawing, caption, _):
            yield caption
            yield from (shape.text for shape in drawing.shapes if isinstance(shape, Label))
        case Signatures(statement, roles):
            yield from (statement, *roles)


def section_of(document: Document, title: str) -> Section:
    return next(section for section in document.sections if section.title == title)


def table_of(document: Document, title: str) -> Table:
    return next(
        block
        for section in document.sections
        for block in section.blocks
        if isinstance(block, Table) and block.title == title
    )


def cells(table: Table, row: int) -> dict[tuple[str, str], str]:
    """A row's texts by group and title of their column."""
    return {(column.group, column.title): text for column, text in zip(table.columns, table.rows[row], strict=True)}
