"""Sessions of browsers: a key for a cookie, kept from scripts and from other sites."""

from __future__ import annotations

from collections.abc import Iterator
from http.cookies import SimpleCookie

import httpx
import pytest

from app.storage.models import BrowserSessionRow
from tests.api.guarding import Guarded
from tests.api.serving import Served, assert_problem

COOKIE = "scattermark_session"
ELSEWHERE = "https://elsewhere.example"


@pytest.fixture
def browser(guarded: Guarded) -> Iterator[httpx.Client]:
    """A browser with a session of a surveyor."""
    with guarded.anonymous() as client:
        secret = guarded.new_key("survey")["secret"]
        assert client.post("/session", json={"key": secret}).status_code == 201
        yield client


def cookie_of(answer: httpx.Response) -> dict[str, str]:
    (morsel,) = SimpleCookie(answer.headers["set-cookie"]).values()
    return {"value": morsel.value, **{name: str(value) for name, value in morsel.items() if value}}


def test_a_cookie_stands_for_the_key(browser: httpx.Client) -> None:
    who = browser.get("/session").json()
    assert (who["name"], who["scopes"]) == ("test", ["survey"])
    assert browser.post("/sites", json={"name": "hall"}).status_code == 201
    assert_problem(browser.get("/keys"), 403, "not-allowed")


def test_no_script_and_no_other_site_gets_the_cookie(guarded: Guarded) -> None:
    made = guarded.new_key("locate", expires_at="2101-01-01T00:00:00Z")
    with guarded.anonymous() as client:
        opened = client.post("/session", json={"key": made["secret"]})
        cookie = cookie_of(opened)
        assert cookie["httponly"] == "True"
        assert cookie["samesite"] == "strict"
        assert cookie["path"] == "/"
        assert "secure" not in cookie  # by http it would never come back
        assert opened.headers["cache-control"] == "no-store"
        assert cookie["value"] not in opened.text
        by_proxy = client.post("/session", json={"key": made["secret"]}, headers={"X-Forwarded-Proto": "https"})
        assert cookie_of(by_proxy)["secure"] == "True"
    for path in guarded.settings.data_dir.glob("scattermark.db*"):
        assert cookie["value"].encode() not in path.read_bytes()


def test_whoever_leaves_is_out(browser: httpx.Client) -> None:
    value = browser.cookies[COOKIE]
    assert browser.delete("/session").status_code == 204
    assert COOKIE not in browser.cookies
    assert_problem(browser.get("/sites"), 401, "not-authenticated")
    browser.cookies.set(COOKIE, value)  # one that was copied
    assert_problem(browser.get("/sites"), 401, "not-authenticated")


def test_a_session_ends_with_its_key(guarded: Guarded, browser: httpx.Client) -> None:
    key_id = browser.get("/session").json()["key_id"]
    assert guarded.client.delete(f"/keys/{key_id}").status_code == 200
    assert_problem(browser.get("/sites"), 401, "not-authenticated")
    with guarded.services.database.reading() as session:
        assert session.query(BrowserSessionRow).filter_by(key_id=key_id).count() == 0


def test_a_session_ends_by_itself(guarded: Guarded, browser: httpx.Client) -> None:
    with guarded.services.database.writing() as session:
        session.query(BrowserSessionRow).update({"expires_s": 1.0})
    guarded.services.gatekeeper.ring.forget_cookie(browser.cookies[COOKIE])
    assert_problem(browser.get("/sites"), 401, "not-authenticated")


def test_a_wrong_key_opens_no_session(guarded: Guarded) -> None:
    with guarded.anonymous() as client:
        refused = client.post("/session", json={"key": "smk_guessed"})
        assert_problem(refused, 401, "not-authenticated")
        assert "set-cookie" not in refused.headers
        assert_problem(client.get("/session"), 401, "not-authenticated")


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": ELSEWHERE}, 403),
        ({"Origin": "null"}, 403),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
        ({"Sec-Fetch-Site": "same-site"}, 403),
        ({"Sec-Fetch-Site": "same-origin"}, 201),
        ({"Sec-Fetch-Site": "none"}, 201),
        ({"Origin": "own"}, 201),
        ({}, 201),
    ],
)
def test_a_page_of_another_site_changes_nothing(browser: httpx.Client, headers: dict[str, str], status: int) -> None:
    place = browser.base_url
    sent = {name: value.replace("own", f"http://{place.host}:{place.port}") for name, value in headers.items()}
    answer = browser.post("/sites", json={"name": "hall"}, headers=sent)
    assert answer.status_code == status, answer.text
    assert browser.get("/sites", headers=sent).status_code == 200  # which its page cannot read


def test_nobody_is_logged_in_by_another_site(guarded: Guarded) -> None:
    with guarded.anonymous() as client:
        body = {"key": guarded.new_key("locate")["secret"]}
        assert_problem(client.post("/session", json=body, headers={"Origin": ELSEWHERE}), 403, "not-allowed")


def test_whoever_shows_a_key_is_no_page_without_one(guarded: Guarded) -> None:
    answer = guarded.client.post("/sites", json={"name": "hall"}, headers={"Origin": ELSEWHERE})
    assert answer.status_code == 201


def test_without_keys_everyone_here_may_do_everything(served: Served) -> None:
    who = served.client.get("/session").json()
    assert who["key_id"] is None
    assert who["scopes"] == ["admin", "analyse", "locate", "survey"]
    assert served.client.delete("/session").status_code == 204
