"""The report of ``scattermark build``: its suffix is its format, and it belongs to the map beside it."""

from __future__ import annotations

import io
import json
from hashlib import sha256
from pathlib import Path

import pytest
from pypdf import PdfReader

from app.cli import main
from app.cli.report_file import write_report_file
from app.photogrammetry.survey import SurveyResult, adjust_survey
from tests.photogrammetry.survey_scene import (
    CONTROL_DOTS,
    PLATE,
    build_room,
    control_points,
    ring_of_stations,
    survey_photos,
)

SITE = "Hall <3> & co"


@pytest.fixture(scope="module")
def survey() -> SurveyResult:
    room = build_room()
    return adjust_survey(survey_photos(room, ring_of_stations(12)), control_points(room, CONTROL_DOTS), PLATE)


@pytest.fixture
def map_path(tmp_path: Path) -> Path:
    path = tmp_path / "map.json"
    path.write_text('{"targets": []}')
    return path


def test_the_suffix_is_the_format(survey: SurveyResult, map_path: Path, tmp_path: Path) -> None:
    for suffix in ("json", "html", "PDF"):
        write_report_file(tmp_path / f"report.{suffix}", survey, map_path, SITE)
    assert json.loads((tmp_path / "report.json").read_text()) == survey.report.to_json()
    html = (tmp_path / "report.html").read_text()
    assert "<h1>Hall &lt;3&gt; &amp; co</h1>" in html
    first_page = PdfReader(io.BytesIO((tmp_path / "report.PDF").read_bytes())).pages[0].extract_text()
    assert SITE in first_page
    digest = sha256(map_path.read_bytes()).hexdigest()
    assert digest in html
    assert digest in "".join(first_page.split())


def test_another_suffix_is_refused_before_any_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["build", str(tmp_path), "--out", str(tmp_path / "map.json"), "--report", "report.docx"])
    assert ".html, .json, .pdf" in capsys.readouterr().err
