"""The service without keys: of this machine alone, whatever a page in its browser tries."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from typing import Any

import pytest

from app.api.origins import TrustedPages, TrustedPagesOnly, is_loopback_name
from app.settings import Settings
from tests.api.serving import Served, assert_problem, serve

PAGE = "https://maps.example.org"


@pytest.mark.parametrize("host", ["evil.example", "evil.example:8000", "127.0.0.1.evil.example", "localhost.evil", "["])
def test_a_name_that_is_not_this_machine_s_is_refused(served: Served, host: str) -> None:
    """DNS rebinding: the page's own name leads to this machine, and the browser says that name."""
    for path in ("/sites", "/healthz"):
        assert_problem(served.client.get(path, headers={"Host": host}), 403, "not-allowed")


@pytest.mark.parametrize(
    "host", ["localhost", "localhost:1234", "127.0.0.1", "[::1]:80", "room.localhost", "127.0.0.2"]
)
def test_names_of_this_machine_are_taken(served: Served, host: str) -> None:
    assert served.client.get("/sites", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("headers", [{"Origin": PAGE}, {"Origin": "null"}, {"Sec-Fetch-Site": "cross-site"}])
def test_a_page_of_another_site_changes_nothing_here(served: Served, headers: dict[str, str]) -> None:
    for method, path in (
        ("POST", "/sites"),
        ("DELETE", "/sites/x"),
        ("PUT", "/surveys/x/images/y"),
        ("POST", "/locate"),
    ):
        assert_problem(served.client.request(method, path, headers=headers), 403, "not-allowed")


def test_a_request_that_came_through_a_proxy_is_not_from_here(served: Served) -> None:
    forwarded = served.client.get("/sites", headers={"X-Forwarded-For": "203.0.113.9"})
    assert_problem(forwarded, 401, "not-authenticated")


def test_a_wrong_key_is_not_taken_for_none(served: Served) -> None:
    refused = served.client.get("/sites", headers={"Authorization": "Bearer smk_old"})
    assert_problem(refused, 401, "not-authenticated")


@pytest.fixture(scope="module")
def friendly(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with a name of its own and a page that may use it."""
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("friendly"),
        locate_workers=1,
        allowed_hosts="positions.example.org, other.example.org",
        cors_origins=PAGE,
    )
    with serve(settings, worker=False) as running:
        yield running


def test_names_that_the_operator_gave_are_taken(friendly: Served) -> None:
    for host in ("positions.example.org", "POSITIONS.example.org:443", "localhost"):
        assert friendly.client.get("/sites", headers={"Host": host}).status_code == 200
    assert friendly.client.get("/sites", headers={"Host": "evil.example"}).status_code == 403


def test_a_page_that_the_operator_named_may_use_the_service(friendly: Served) -> None:
    asked = {"Origin": PAGE, "Access-Control-Request-Method": "PUT", "Access-Control-Request-Headers": "authorization"}
    allowed = friendly.client.options("/sites", headers=asked)
    assert allowed.status_code == 200
    assert allowed.headers["access-control-allow-origin"] == PAGE
    assert "access-control-allow-credentials" not in allowed.headers
    made = friendly.client.post("/sites", json={"name": "x"}, headers={"Origin": PAGE, "Sec-Fetch-Site": "cross-site"})
    assert made.status_code == 201
    assert made.headers["access-control-allow-origin"] == PAGE
    refused = friendly.client.get("/nowhere", headers={"Origin": PAGE})
    assert refused.headers["access-control-allow-origin"] == PAGE  # problems can be read as well


def test_any_other_page_gets_no_word(friendly: Served, served: Served) -> None:
    for running, origin in ((friendly, "https://evil.example"), (served, PAGE)):
        answer = running.client.get("/sites", headers={"Origin": origin})
        assert "access-control-allow-origin" not in answer.headers
    asked = {"Origin": PAGE, "Access-Control-Request-Method": "PUT"}
    assert served.client.options("/sites", headers=asked).status_code == 405


def handshake(trusted: TrustedPages, **headers: str) -> list[dict[str, Any]]:
    """What a WebSocket's handshake is answered."""
    reached: list[dict[str, Any]] = []

    async def inside(_scope: Any, _receive: Any, send: Any) -> None:
        await send({"type": "websocket.accept"})

    async def send(message: Any) -> None:
        reached.append(message)

    raw = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    offered = headers.get("sec_websocket_protocol", "").split(", ")
    scope = {"type": "websocket", "scheme": "ws", "path": "/locate/stream", "headers": raw, "subprotocols": offered,
             "query_string": b"", "server": ("127.0.0.1", 80)}  # fmt: skip
    asyncio.run(TrustedPagesOnly(inside, trusted)(scope, None, send))  # type: ignore[arg-type]
    return reached


@pytest.mark.parametrize("check_host", [False, True])
def test_websockets_ask_where_a_page_is_from(check_host: bool) -> None:
    trusted = TrustedPages(check_host)
    assert handshake(trusted, host="localhost", origin="http://localhost")[0]["type"] == "websocket.accept"
    assert handshake(trusted, host="localhost")[0]["type"] == "websocket.accept"
    refused = handshake(trusted, host="localhost", origin=PAGE)
    assert refused[0]["type"] == "websocket.http.response.start"
    assert refused[0]["status"] == 403
    with_key = handshake(trusted, host="localhost", origin=PAGE, sec_websocket_protocol="scattermark, bearer.smk_x")
    assert with_key[0]["type"] == "websocket.accept"  # and the key is looked at next


@pytest.mark.parametrize(
    ("name", "here"),
    [("localhost", True), ("a.localhost", True), ("127.8.9.1", True), ("::1", True), ("", False), ("10.0.0.1", False)],
)
def test_names_of_loopback(name: str, here: bool) -> None:
    assert is_loopback_name(name) is here
