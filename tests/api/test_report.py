"""The report over HTTP: what a surveyor signs, of the real survey of the demonstration room."""

from __future__ import annotations

import io
import re
from hashlib import sha256

import httpx
import pytest
from pypdf import PdfReader

from app.api.report_answer import preferred_format
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem, room_photos

HOSTILE = '<script>alert("room")</script>'


def get_report(served: Served, room: SurveyedRoom, **query: str) -> httpx.Response:
    return served.client.get(f"/sites/{room.site_id}/report", params={"version": "1", **query})


def test_json_is_the_adjustment(served: Served, room: SurveyedRoom) -> None:
    answer = get_report(served, room, format="json")
    assert answer.headers["content-type"] == "application/json"
    report = answer.json()
    assert (report["site_id"], report["map_version"], report["photographs_left_out"]) == (room.site_id, 1, [])
    assert report["excluded"] == {"images": [], "codes": [], "control_points": []}
    (residuals,) = report["image_residuals"]
    assert sum(map(sum, residuals["counts"])) == report["observations"] / 2


def test_html_tells_every_photograph_and_target(served: Served, room: SurveyedRoom) -> None:
    answer = get_report(served, room, format="html")
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    text = re.sub(r"<[^>]+>", "\n", answer.text).splitlines()
    assert set(room_photos("survey")) <= set(text)
    targets = served.client.get(f"/sites/{room.site_id}/targets", params={"version": 1}).json()["targets"]
    assert {str(target["code"]) for target in targets} <= set(text)


def test_a_browser_may_do_nothing_with_the_page_but_show_it(served: Served, room: SurveyedRoom) -> None:
    headers = get_report(served, room, format="html").headers
    policy = headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; style-src 'sha256-")
    assert "frame-ancestors 'none'" in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["content-disposition"] == f'inline; filename="scattermark-{room.site_id}-v1.html"'


def test_pdf_holds_the_digest_of_the_map_that_anyone_can_fetch(served: Served, room: SurveyedRoom) -> None:
    answer = get_report(served, room, format="pdf")
    assert answer.headers["content-type"] == "application/pdf"
    reader = PdfReader(io.BytesIO(answer.content))
    csv = served.client.get(f"/sites/{room.site_id}/targets", params={"format": "csv", "version": 1}).content
    first_page = "".join(reader.pages[0].extract_text().split())
    assert sha256(csv).hexdigest() in first_page
    assert "16of16" in first_page


@pytest.mark.parametrize(
    ("accept", "format_name"),
    [
        ("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8", "html"),
        ("application/pdf", "pdf"),
        ("application/json", "json"),
        ("*/*", "json"),
        ("", "json"),
    ],
)
def test_browsers_get_a_page_and_programs_json(accept: str, format_name: str) -> None:
    assert preferred_format(accept) == format_name


def test_the_header_is_heard_when_the_query_names_no_format(served: Served, room: SurveyedRoom) -> None:
    url = f"/sites/{room.site_id}/report"
    page = served.client.get(url, params={"version": 1}, headers={"Accept": "text/html,*/*;q=0.8"})
    assert page.text.startswith("<!DOCTYPE html>")
    assert page.headers["vary"] == "Accept"
    assert served.client.get(url, params={"version": 1}).json()["map_version"] == 1


def test_the_sites_name_is_only_text(served: Served, room: SurveyedRoom) -> None:
    name = served.client.get(f"/sites/{room.site_id}").json()["name"]
    served.client.patch(f"/sites/{room.site_id}", json={"name": HOSTILE})
    try:
        html = get_report(served, room, format="html").text
        pdf = PdfReader(io.BytesIO(get_report(served, room, format="pdf").content))
    finally:
        served.client.patch(f"/sites/{room.site_id}", json={"name": name})
    assert "<script" not in html
    assert "<h1>&lt;script&gt;" in html
    assert HOSTILE in pdf.pages[0].extract_text()


def test_reports_that_do_not_exist(served: Served, room: SurveyedRoom) -> None:
    assert_problem(get_report(served, room, format="docx"), 422, "invalid-input")
    for format_name in ("html", "json", "pdf"):
        assert_problem(get_report(served, room, format=format_name, version="99"), 404, "not-found")
    bare = served.new_site()
    assert_problem(served.client.get(f"/sites/{bare}/report", params={"format": "html"}), 409, "conflict")
    assert_problem(served.client.get("/sites/nowhere/report", params={"format": "pdf"}), 404, "not-found")
