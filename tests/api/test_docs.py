"""The page that describes the interface: whole, and of this service alone."""

from __future__ import annotations

import re
from html import unescape
from typing import Any

from app.api.docs_page import STYLE_DIGEST, docs_page
from tests.api.serving import Served


def document_of(**call: Any) -> dict[str, Any]:
    described = {"responses": {"200": {"description": "fine"}}, **call}
    return {"info": {"title": "T"}, "paths": {"/x": {"get": described}}, "components": {"schemas": {"A": {}}}}


def test_every_call_and_every_schema_is_there(served: Served) -> None:
    document = served.client.get("/openapi.json").json()
    page = unescape(served.client.get("/docs").text)
    for path, methods in document["paths"].items():
        for method in methods:
            assert f"<code>{method.upper()} {path}</code>" in page
    for name in document["components"]["schemas"]:
        assert f'id="{name}"' in page


def test_it_runs_nothing_and_asks_nobody(served: Served) -> None:
    answer = served.client.get("/docs")
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert "<script" not in answer.text
    assert set(re.findall(r'(?:href|src)="([^#"][^"]*)"', answer.text)) == {"openapi.json"}
    (policy,) = answer.headers.get_list("content-security-policy")
    assert policy.startswith("default-src 'none'")
    assert f"'sha256-{STYLE_DIGEST}'" in policy


def test_what_a_description_holds_is_text() -> None:
    page = docs_page(document_of(description="<b>bold</b>", summary="<i>", tags=["<u>"]))
    assert not re.search("<b>|<i>|<u>", page)
    assert "&lt;b&gt;bold&lt;/b&gt;" in page


def test_scopes_bodies_and_answers_are_named() -> None:
    reference = {"schema": {"$ref": "#/components/schemas/A"}}
    page = docs_page(
        document_of(
            security=[{"key": ["locate"]}, {"key": ["survey"]}],
            requestBody={"content": {"application/json": reference}},
            parameters=[{"name": "limit", "in": "query", "required": True}],
        )
    )
    for words in ("scope locate or survey", '<a href="#A">A</a>', "application/json", "limit", "required", "fine"):
        assert words in page


def test_the_framework_s_pages_are_gone(served: Served) -> None:
    for path in ("/redoc", "/docs/oauth2-redirect"):
        assert served.client.get(path).status_code == 404
