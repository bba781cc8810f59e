"""The files stand alone, say what the document says, and show every text as text."""

from __future__ import annotations

import io
import json
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from pypdf import PdfReader

from app.services.evaluation_report.compose import compose
from app.services.evaluation_report.files import html_report, pdf_report, zip_report
from app.services.evaluation_report.material import ReportMaterial
from app.services.reporting.document import Document
from app.services.reporting.pdf.fonts import written
from app.services.reporting.text import readable
from app.trajectories.evaluation_record import record_of_evaluation
from tests.services.evaluation_report.scene import hostile
from tests.services.reporting.names import HOSTILE
from tests.services.reporting.page import TAGS, Page
from tests.services.reporting.texts import texts_of


@pytest.fixture(scope="module")
def html(material: ReportMaterial) -> str:
    return html_report(material).decode()


@pytest.fixture(scope="module")
def nasty() -> ReportMaterial:
    return hostile()


def without_spaces(text: str) -> str:
    return "".join(text.split())


def said(content: bytes) -> str:
    return "".join(without_spaces(page.extract_text()) for page in PdfReader(io.BytesIO(content)).pages)


def test_the_page_says_all_and_fetches_nothing(html: str, report: Document) -> None:
    page = Page(html)
    assert page.open == [] and page.tags <= TAGS
    assert [text for text in texts_of(report) if text and readable(text) not in set(page.text)] == []
    targets = {value for _, name, value in page.attributes if name in ("href", "src", "srcset", "action", "data")}
    assert all(value.startswith("#part-") for value in targets)
    assert "http" not in html.replace("http-equiv", "")


def test_each_drawing_is_well_formed(html: str, material: ReportMaterial) -> None:
    drawings = [f"<svg{part.split('</svg>')[0]}</svg>" for part in html.split("<svg")[1:]]
    assert len(drawings) == 4 + 4 * len(material.evaluations)
    for drawing in drawings:
        root = ElementTree.fromstring(drawing)
        assert float(root.attrib["viewBox"].split()[3]) > 0
        assert "nan" not in drawing and "inf" not in drawing.replace("info", "")


def test_the_pdf_says_all_and_is_outlined(material: ReportMaterial, report: Document) -> None:
    content = pdf_report(material)
    text = said(content)
    assert [part for part in texts_of(report) if without_spaces(part) not in text] == []
    outline = PdfReader(io.BytesIO(content)).outline
    assert [entry.title for entry in outline] == [section.title for section in report.sections]  # type: ignore[union-attr]


def test_names_of_the_worst_kind_are_only_text(nasty: ReportMaterial) -> None:
    page = Page(html_report(nasty).decode())
    assert page.open == [] and page.tags <= TAGS
    assert not {name for _, name, _ in page.attributes if name.startswith("on") or name in ("style", "src")}
    shown, printed = "\n".join(page.text), said(pdf_report(nasty))
    assert [name for name in HOSTILE if readable(name)[:100] not in shown] == []
    assert [name for name in HOSTILE if without_spaces(written(name))[:100] not in printed] == []


def test_the_archive_of_several_holds_a_result_each(material: ReportMaterial) -> None:
    with zipfile.ZipFile(io.BytesIO(zip_report(material))) as archive:
        results = {f"evo/{name}.zip" for name in material.evaluations}
        assert set(archive.namelist()) == {"report.html", "report.pdf", "evaluation.json", *results}
        record = json.loads(archive.read("evaluation.json"))
        uwb = material.evaluations["UWB"]
        assert record["evaluations"]["UWB"] == json.loads(json.dumps(record_of_evaluation(uwb)))
        with zipfile.ZipFile(archive.open("evo/UWB.zip")) as result:
            errors_m = np.load(result.open("error_array.npy"))
    np.testing.assert_array_equal(errors_m, uwb.errors.spatial_m)


def test_no_name_leads_out_of_the_archive(nasty: ReportMaterial) -> None:
    with zipfile.ZipFile(io.BytesIO(zip_report(nasty))) as archive:
        names = [name for name in archive.namelist() if name.startswith("evo/")]
    assert len(names) == len({name.lower() for name in names}) == len(HOSTILE)
    assert all(name.count("/") == 1 and not name.startswith("evo/.") and "\\" not in name for name in names)


def test_the_same_material_is_packed_to_the_same_bytes(single: ReportMaterial) -> None:
    first, second = (dict(_contents(zip_report(single))) for _ in range(2))
    assert {name for name in first if first[name] != second[name]} <= {"report.pdf"}  # it tells when it was made


def _contents(content: bytes) -> list[tuple[str, bytes]]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return [(name, archive.read(name)) for name in archive.namelist()]


def test_the_document_is_composed_of_the_material_alone(material: ReportMaterial, report: Document) -> None:
    assert list(texts_of(compose(material))) == list(texts_of(report))
