"""Tables of any size keep to their pages."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from pypdf import PdfReader

from app.services.reporting.document import Column, Document, Section, Table
from app.services.reporting.pdf.file import pdf_of
from app.services.reporting.pdf.fonts import REGULAR, width_of
from app.services.reporting.pdf.tables import PAD, SIZES, lay_out


def read(document: Document) -> PdfReader:
    return PdfReader(io.BytesIO(pdf_of(document)))


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
