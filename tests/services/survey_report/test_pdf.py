"""The PDF says what the document says, shows every text as text, and keeps its tables on its pages."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from pypdf import PdfReader

from app.services.survey_report.document import Column, Document, Section, Table
from app.services.survey_report.html.page import STYLE
from app.services.survey_report.pdf.file import pdf_of
from app.services.survey_report.pdf.fonts import REGULAR, width_of, written
from app.services.survey_report.pdf.look import INKS
from app.services.survey_report.pdf.tables import PAD, SIZES, lay_out
from tests.services.survey_report.scene import HOSTILE
from tests.services.survey_report.texts import texts_of

A4 = (595, 842)


def read(document: Document) -> PdfReader:
    return PdfReader(io.BytesIO(pdf_of(document)))


def without_spaces(text: str) -> str:
    return "".join(text.split())


def said(reader: PdfReader) -> str:
    """The text of all pages; where lines break is the page's affair."""
    return "".join(without_spaces(page.extract_text()) for page in reader.pages)


@pytest.fixture(scope="module")
def reader(document: Document) -> PdfReader:
    return read(document)


@pytest.fixture(scope="module")
def faulty_reader(faulty_document: Document) -> PdfReader:
    return read(faulty_document)


def test_the_file_says_all_that_the_document_says(reader: PdfReader, document: Document) -> None:
    text = said(reader)
    assert [part for part in texts_of(document) if without_spaces(part) not in text] == []


def test_the_file_is_titled_outlined_and_numbered(reader: PdfReader, document: Document) -> None:
    assert reader.metadata is not None
    assert reader.metadata.title == "Survey report: Hall 3, map version 7"
    assert [entry.title for entry in reader.outline] == [section.title for section in document.sections]  # type: ignore[union-attr]
    for number, page in enumerate(reader.pages, start=1):
        assert f"page{number}" in without_spaces(page.extract_text())


def test_broad_tables_lie_on_broad_pages(reader: PdfReader) -> None:
    sizes = [(round(page.mediabox.width), round(page.mediabox.height)) for page in reader.pages]
    assert sizes[0] == A4
    assert sizes[-1] == A4
    assert A4[::-1] in sizes


def test_names_of_the_worst_kind_are_only_text(faulty_reader: PdfReader) -> None:
    text = said(faulty_reader)
    assert [name for name in HOSTILE if without_spaces(written(name))[:100] not in text] == []


def test_nothing_in_the_file_acts(faulty_reader: PdfReader) -> None:
    assert not faulty_reader.attachments
    assert faulty_reader.get_fields() is None
    assert {"/OpenAction", "/AA", "/AcroForm", "/Names"}.isdisjoint(faulty_reader.trailer["/Root"])
    for page in faulty_reader.pages:
        assert "/Annots" not in page
        assert not page.images


def test_characters_beyond_the_font_are_named() -> None:
    assert written("Łódź Ωmega − ± µ") == "Łódź Ωmega − ± µ"  # noqa: RUF001 - a real minus
    assert written("会 🙂") == "[U+4F1A] [U+1F642]"
    assert written("a\u202eb\x00") == "a�b�"


def test_colours_are_those_of_the_page() -> None:
    light = dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", STYLE.split("@media")[0]))
    assert {name: colour.hexval().replace("0x", "#") for name, colour in INKS.items()} == {
        name: light[name] for name in INKS
    }


def table(names: list[str], numbers: int) -> Table:
    columns = (Column("Name", align="left"), *(Column(f"n{index}", "Group") for index in range(numbers)))
    return Table("Sample", columns, tuple((name, *["-123.4567"] * numbers) for name in names))


@pytest.mark.parametrize(("length", "numbers"), [(10, 3), (400, 3), (10, 20), (400, 20), (10, 60)])
def test_a_table_is_never_broader_than_its_page(length: int, numbers: int) -> None:
    layout = lay_out(table(["x" * length], numbers), 500.0)
    assert sum(layout.widths) <= 500.0 + 1e-6
    if layout.size > SIZES[-1]:  # numbers are never broken while the type can be made smaller
        assert min(layout.widths[1:]) >= width_of("-123.4567", REGULAR, layout.size) + 2 * PAD - 1e-6


def one_table(rows: int) -> Document:
    section = Section("Sample", (table([f"row {index}" for index in range(rows)], 12),), wide=True)
    return Document("Report", "sample", "sample", "test", (section,))


def test_rows_that_fill_pages_repeat_their_titles() -> None:
    reader = read(one_table(300))
    assert len(reader.pages) > 4
    assert all("Name" in page.extract_text() for page in reader.pages[1:])
    assert "row 299" in reader.pages[-1].extract_text()


def test_runs_of_rows_lose_none() -> None:
    marked = replace(table([f"row {index}" for index in range(900)], 3), marked=frozenset({0, 399, 400, 899}))
    document = Document("Report", "sample", "sample", "test", (Section("Sample", (marked,)),))
    text = "\n".join(page.extract_text() for page in read(document).pages)
    assert [int(found) for found in re.findall(r"row (\d+)", text)] == list(range(900))


def test_a_long_title_stays_on_its_line(document: Document) -> None:
    reader = read(replace(document, running_title="room " * 100))
    head = reader.pages[1].extract_text().splitlines()[0]
    assert head.endswith("…")
