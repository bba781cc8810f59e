"""Keys over HTTP: made, used, bound, limited, revoked."""

from __future__ import annotations

import socket
import time

import pytest

from tests.api.guarding import ADMIN_SECRET, Guarded
from tests.api.serving import assert_problem

ANSWER_S = 30.0
PAST, FUTURE = "2001-01-01T00:00:00Z", "2101-01-01T00:00:00Z"


def test_a_key_opens_what_its_scope_says(guarded: Guarded) -> None:
    made = guarded.new_key("survey", expires_at=FUTURE)
    assert made["secret"].startswith("smk_")
    assert len(made["secret"]) == 4 + 43  # 256 bits as base64
    assert made["hint"] == made["secret"][:8]
    assert made["expires_at"].startswith("2101-01-01")
    with guarded.with_secret(made["secret"]) as client:
        assert client.post("/sites", json={"name": "hall"}).status_code == 201
        assert_problem(client.get("/keys"), 403, "not-allowed")


def test_a_secret_is_told_once_and_kept_nowhere(guarded: Guarded) -> None:
    answer = guarded.client.post("/keys", json={"name": "phone", "scopes": ["locate"]})
    assert answer.headers["cache-control"] == "no-store"
    made = answer.json()
    shown = guarded.client.get(f"/keys/{made['key_id']}").json()
    assert shown == {name: value for name, value in made.items() if name != "secret"}
    listed = guarded.client.get("/keys", params={"limit": 1000})
    assert shown["key_id"] in listed.text
    assert made["secret"] not in listed.text
    for path in guarded.settings.data_dir.glob("scattermark.db*"):
        assert made["secret"].encode() not in path.read_bytes()


def test_a_revoked_key_opens_nothing_and_stays_listed(guarded: Guarded) -> None:
    made = guarded.new_key("locate")
    with guarded.with_secret(made["secret"]) as client:
        assert client.get("/sites").status_code == 200
        revoked = guarded.client.delete(f"/keys/{made['key_id']}").json()
        assert revoked["revoked_at"] is not None
        assert_problem(client.get("/sites"), 401, "not-authenticated")
    assert guarded.client.delete(f"/keys/{made['key_id']}").json() == revoked
    assert_problem(guarded.client.delete("/keys/nothing"), 404, "not-found")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"scopes": []}, "scopes"),
        ({"scopes": ["fly"]}, "scopes"),
        ({"scopes": ["locate"], "expires_at": PAST}, "expired already"),
        ({"scopes": ["locate"], "expires_at": "soon"}, "expires_at"),
        ({"scopes": ["locate"], "rate_per_s": 0}, "rate_per_s"),
        ({"scopes": ["locate"], "burst": 0}, "burst"),
        ({"scopes": ["locate"], "site_ids": []}, "site_ids"),
        ({"scopes": ["locate"], "name": " "}, "name"),
        ({"scopes": ["locate"], "secret": "mine"}, "secret"),
    ],
)
def test_keys_that_make_no_sense_are_refused(guarded: Guarded, body: dict[str, object], words: str) -> None:
    problem = assert_problem(guarded.client.post("/keys", json={"name": "x", **body}), 422, "invalid-input")
    assert words in problem["detail"]


def test_a_key_of_a_site_that_is_not_there_is_refused(guarded: Guarded) -> None:
    body = {"name": "x", "scopes": ["locate"], "site_ids": ["nowhere"]}
    assert_problem(guarded.client.post("/keys", json=body), 404, "not-found")


@pytest.mark.parametrize("header", ["Bearer", "bearer smk_no", "Basic c21rXw==", f"Token {ADMIN_SECRET}"])
def test_what_is_no_key_opens_nothing(guarded: Guarded, header: str) -> None:
    with guarded.anonymous() as client:
        assert_problem(client.get("/sites", headers={"Authorization": header}), 401, "not-authenticated")


def test_the_scheme_is_written_as_one_likes(guarded: Guarded) -> None:
    with guarded.anonymous() as client:
        assert client.get("/sites", headers={"Authorization": f"bEARER  {ADMIN_SECRET}"}).status_code == 200


def test_nobody_is_refused_before_a_body_comes(guarded: Guarded) -> None:
    """An upload is announced, none of it is sent, and the answer is there."""
    place = guarded.client.base_url
    head = "POST /sites/import HTTP/1.1\r\nHost: x\r\nContent-Length: 1000000\r\n\r\n"
    with socket.create_connection((place.host, place.port), timeout=ANSWER_S) as connection:
        connection.sendall(head.encode())
        assert connection.recv(1000).startswith(b"HTTP/1.1 401 ")


def test_a_key_that_asks_too_often_waits(guarded: Guarded) -> None:
    with guarded.holder("locate", rate_per_s=0.01, burst=3) as hasty, guarded.holder("locate") as calm:
        assert [hasty.get("/sites").status_code for _ in range(3)] == [200, 200, 200]
        refused = hasty.get("/sites")
        problem = assert_problem(refused, 429, "too-many-requests")
        assert 1 <= int(refused.headers["Retry-After"]) == problem["retry_after_s"] <= 100
        assert_problem(hasty.post("/locate"), 429, "too-many-requests")
        assert calm.get("/sites").status_code == 200


def test_uses_of_keys_are_kept(guarded: Guarded) -> None:
    began_s = time.time()
    with guarded.holder("locate") as client:
        key_id = client.get("/session").json()["key_id"]
    guarded.services.gatekeeper.ring.write_uses()
    used_at = guarded.client.get(f"/keys/{key_id}").json()["last_used_at"]
    assert used_at >= time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(began_s))
