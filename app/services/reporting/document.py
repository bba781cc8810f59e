"""A document without a format: sections of blocks, all of it text as it is meant to be read, never markup."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from app.services.reporting.drawing import Drawing


@dataclass(frozen=True)
class Paragraph:
    """Running text."""

    text: str


@dataclass(frozen=True)
class Facts:
    """Names and what they stand for, a line each."""

    lines: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class KeyFigure:
    """A number to be seen first, and what it is about."""

    value: str
    label: str
    detail: str = ""


@dataclass(frozen=True)
class KeyFigures:
    """Numbers to be seen first."""

    figures: tuple[KeyFigure, ...]


@dataclass(frozen=True)
class Finding:
    """Something that the reader must know; ``grave`` when it bears on whether to sign."""

    title: str
    text: str
    grave: bool


@dataclass(frozen=True)
class Findings:
    """All that the reader must know, the gravest first."""

    findings: tuple[Finding, ...]


@dataclass(frozen=True)
class Column:
    """A column; neighbours of one group stand under its title together."""

    title: str
    group: str = ""
    align: Literal["left", "right"] = "right"


@dataclass(frozen=True)
class Table:
    """Rows of text.

    Attributes
    ----------
    title : str
        What the table holds, for its caption.
    columns : tuple of Column
    rows : tuple of tuple of str
        As many texts as columns each; the first one names the row.
    note : str
        What a reader of the table must know.
    marked : frozenset of int
        Rows that stand out; the text says why.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    marked: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        if any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(f"each row of {self.title!r} needs {len(self.columns)} texts")


@dataclass(frozen=True)
class Figure:
    """A drawing with its caption, and what it shows for those who do not see it."""

    drawing: Drawing
    caption: str
    description: str


@dataclass(frozen=True)
class Signatures:
    """What is signed, and by whom."""

    statement: str
    roles: tuple[str, ...]


Block = Paragraph | Facts | KeyFigures | Findings | Table | Figure | Signatures


@dataclass(frozen=True)
class Section:
    """A part with a title; ``wide`` when its tables need the page's longer side."""

    title: str
    blocks: tuple[Block, ...]
    wide: bool = False


@dataclass(frozen=True)
class Document:
    """A whole document.

    Attributes
    ----------
    title, subject : str
        What it is, and what it is about.
    running_title : str
        One line for the head of each page.
    producer : str
        The software, for the foot of each page.
    sections : tuple of Section
    """

    title: str
    subject: str
    running_title: str
    producer: str
    sections: tuple[Section, ...]
