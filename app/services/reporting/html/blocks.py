"""The document's blocks as HTML. All text is escaped here and nowhere else."""

from __future__ import annotations

from html import escape
from itertools import groupby

from app.services.reporting.document import (
    Block,
    Column,
    Facts,
    Figure,
    Findings,
    KeyFigure,
    KeyFigures,
    Paragraph,
    Section,
    Signatures,
    Table,
)
from app.services.reporting.html.svg import svg_of
from app.services.reporting.text import readable


def shown(text: str) -> str:
    """Text as it may stand in an element or between double quotes."""
    return escape(readable(text))


def section_html(section: Section, anchor: str) -> str:
    """A section with its title."""
    blocks = "".join(_block(block) for block in section.blocks)
    wide = ' class="wide"' if section.wide else ""
    title = f'<h2 id="{anchor}-title">{shown(section.title)}</h2>'
    return f'<section{wide} id="{anchor}" aria-labelledby="{anchor}-title">{title}{blocks}</section>\n'


def _block(block: Block) -> str:
    match block:
        case Paragraph(text):
            return f"<p>{shown(text)}</p>"
        case Facts(lines):
            return f"<dl>{''.join(f'<dt>{shown(name)}</dt><dd>{shown(text)}</dd>' for name, text in lines)}</dl>"
        case KeyFigures(figures):
            return f'<ul class="figures">{"".join(map(_key_figure, figures))}</ul>'
        case Findings():
            return _findings(block)
        case Table():
            return _table(block)
        case Figure(drawing, caption, description):
            return f"<figure>{svg_of(drawing, description)}<figcaption>{shown(caption)}</figcaption></figure>"
        case Signatures():
            return _signatures(block)


def _key_figure(figure: KeyFigure) -> str:
    detail = f"<small>{shown(figure.detail)}</small>" if figure.detail else ""
    return f"<li><strong>{shown(figure.value)}</strong><span>{shown(figure.label)}</span>{detail}</li>"


def _findings(block: Findings) -> str:
    items = []
    for finding in block.findings:
        kind, word = ("grave", "Warning") if finding.grave else ("plain", "Note")
        items.append(
            f'<li class="{kind}"><strong>{word}: {shown(finding.title)}</strong><p>{shown(finding.text)}</p></li>'
        )
    return f'<ul class="findings">{"".join(items)}</ul>'


def _table(table: Table) -> str:
    caption = f"<caption>{shown(table.title)}</caption>"
    head = f"<thead>{_head(table.columns)}</thead>"
    rows = "".join(_row(row, table.columns, index in table.marked) for index, row in enumerate(table.rows))
    note = f'<p class="note">{shown(table.note)}</p>' if table.note else ""
    scroll = f'<div class="scroll" role="region" tabindex="0" aria-label="{shown(table.title)}">'
    return f"{scroll}<table>{caption}{head}<tbody>{rows}</tbody></table></div>{note}"


def _head(columns: tuple[Column, ...]) -> str:
    """One line of titles, or two when columns form groups."""
    if not any(column.group for column in columns):
        return f"<tr>{''.join(_title(column) for column in columns)}</tr>"
    upper: list[str] = []
    lower: list[str] = []
    for group, members in groupby(columns, key=lambda column: column.group):
        if group:
            titles = list(members)
            upper.append(f'<th scope="colgroup" colspan="{len(titles)}">{shown(group)}</th>')
            lower.extend(_title(column) for column in titles)
        else:
            upper.extend(_title(column, ' rowspan="2"') for column in members)
    return f"<tr>{''.join(upper)}</tr><tr>{''.join(lower)}</tr>"


def _title(column: Column, rows: str = "") -> str:
    return f'<th scope="col" class="{column.align}"{rows}>{shown(column.title)}</th>'


def _row(texts: tuple[str, ...], columns: tuple[Column, ...], marked: bool) -> str:
    first = f'<th scope="row" class="{columns[0].align}">{shown(texts[0])}</th>'
    others = "".join(
        f'<td class="{column.align}">{shown(text)}</td>' for text, column in zip(texts[1:], columns[1:], strict=True)
    )
    start = '<tr class="marked">' if marked else "<tr>"
    return f"{start}{first}{others}</tr>\n"


def _signatures(block: Signatures) -> str:
    lines = "".join(f"<dt>{line}</dt><dd></dd>" for line in ("Name", "Place and date", "Signature"))
    roles = "".join(f'<div class="signature"><h3>{shown(role)}</h3><dl>{lines}</dl></div>' for role in block.roles)
    return f'<p>{shown(block.statement)}</p><div class="signatures">{roles}</div>'
