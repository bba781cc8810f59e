"""The page stands alone, runs nothing, shows every text as text, and can be read in light and in dark."""

from __future__ import annotations

import re
from base64 import b64encode
from hashlib import sha256

import pytest

from app.services.reporting.document import Document
from app.services.reporting.html.page import CONTENT_SECURITY_POLICY, STYLE, html_of
from app.services.reporting.text import readable
from tests.services.reporting.names import HOSTILE
from tests.services.reporting.page import TAGS, Page
from tests.services.reporting.texts import texts_of


@pytest.fixture(scope="module")
def html(document: Document) -> str:
    return html_of(document)


@pytest.fixture(scope="module")
def faulty_page(faulty_document: Document) -> Page:
    return Page(html_of(faulty_document))


def test_the_page_is_whole_and_says_all_that_the_document_says(html: str, document: Document) -> None:
    page = Page(html)
    assert page.open == []
    assert page.tags <= TAGS
    said = set(page.text)
    assert [text for text in texts_of(document) if text and text not in said] == []


def test_nothing_is_fetched_and_nothing_runs(html: str) -> None:
    page = Page(html)
    targets = {value for _, name, value in page.attributes if name in ("href", "src", "srcset", "action", "data")}
    assert all(value.startswith("#part-") for value in targets)
    anchors = {f"#{value}" for _, name, value in page.attributes if name == "id"}
    assert targets <= anchors
    assert not {name for _, name, _ in page.attributes if name.startswith("on") or name == "style"}
    assert not re.search(r"url\(|@import|https?:|//", STYLE)


def test_the_policy_allows_this_style_and_nothing_else(html: str) -> None:
    (style,) = re.findall(r"<style>(.*?)</style>", html, re.DOTALL)
    digest = b64encode(sha256(style.encode()).digest()).decode()
    assert f"style-src 'sha256-{digest}'" in CONTENT_SECURITY_POLICY
    assert "default-src 'none'" in CONTENT_SECURITY_POLICY
    assert ("meta", "content", CONTENT_SECURITY_POLICY) in Page(html).attributes


def test_names_of_the_worst_kind_are_only_text(faulty_page: Page) -> None:
    assert faulty_page.open == []
    assert faulty_page.tags <= TAGS
    assert not {name for _, name, _ in faulty_page.attributes if name.startswith("on") or name in ("style", "src")}
    said = "\n".join(faulty_page.text)
    for name in HOSTILE:
        assert readable(name)[:100] in said


def test_what_cannot_be_seen_is_shown_as_missing(faulty_page: Page) -> None:
    said = "".join(faulty_page.text)
    assert "turned � gpj.exe" in said
    assert all(letter.isprintable() or letter == "\n" for letter in said)


def test_tables_can_be_heard(html: str) -> None:
    page = Page(html)
    scopes = {value for tag, name, value in page.attributes if (tag, name) == ("th", "scope")}
    assert scopes == {"col", "colgroup", "row"}
    drawings = [value for tag, name, value in page.attributes if (tag, name) == ("svg", "aria-label")]
    assert drawings
    assert all(len(words) > 20 for words in drawings)
    assert ("html", "lang", "en") in page.attributes
