"""The PDF says what the document says, shows every text as text, and keeps its tables on its pages."""

from __future__ import annotations

import io
from dataclasses import replace

import pytest
from pypdf import PdfReader

from app.services.reporting.document import Document
from app.services.reporting.pdf.file import pdf_of
from app.services.reporting.pdf.fonts import written
from tests.services.reporting.names import HOSTILE
from tests.services.reporting.texts import texts_of

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


def test_a_long_title_stays_on_its_line(document: Document) -> None:
    reader = read(replace(document, running_title="room " * 100))
    head = reader.pages[1].extract_text().splitlines()[0]
    assert head.endswith("…")
