"""Every answer tells browsers what not to do with it."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from app.api.security_headers import HEADERS, SecurityHeaders
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served


@pytest.mark.parametrize(
    ("method", "path"),
    [("GET", "/sites"), ("GET", "/nowhere"), ("POST", "/sites"), ("TRACE", "/sites"), ("GET", "/docs")],
)
def test_every_answer_has_them(served: Served, method: str, path: str) -> None:
    answer = served.client.request(method, path)
    assert set(HEADERS) <= {name.title() for name in answer.headers}
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
    assert "strict-transport-security" not in answer.headers  # of TLS alone


def test_a_refused_host_has_them_too(served: Served) -> None:
    assert "x-frame-options" in served.client.get("/sites", headers={"Host": "evil.example"}).headers


def test_the_report_keeps_its_own_policy(served: Served, room: SurveyedRoom) -> None:
    page = served.client.get(f"/sites/{room.site_id}/report", params={"format": "html"})
    (policy,) = page.headers.get_list("content-security-policy")
    assert "style-src 'sha256-" in policy
    assert "default-src 'none'" in policy


def sent_headers(scheme: str) -> dict[bytes, bytes]:
    """What an answer over a scheme gets."""
    messages: list[Any] = []

    async def inside(_scope: Any, _receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": [(b"referrer-policy", b"own")]})

    async def send(message: Any) -> None:
        messages.append(message)

    asyncio.run(SecurityHeaders(inside)({"type": "http", "scheme": scheme}, None, send))  # type: ignore[arg-type]
    return dict(messages[0]["headers"])


def test_tls_is_asked_for_where_it_is_spoken() -> None:
    assert sent_headers("https")[b"strict-transport-security"].startswith(b"max-age=")
    assert b"strict-transport-security" not in sent_headers("http")


def test_what_an_answer_says_itself_stands() -> None:
    assert sent_headers("http")[b"referrer-policy"] == b"own"
