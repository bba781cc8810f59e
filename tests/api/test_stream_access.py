"""The handshake of a WebSocket is guarded like a request, and pages of other sites do not get through it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from app.storage.target_maps import TargetMapRepository
from tests.api.guarding import Guarded
from tests.storage import examples

OPEN_S = 60.0


@pytest.fixture(scope="module")
def site_id(guarded: Guarded) -> str:
    made = guarded.new_site()
    survey_id = guarded.new_survey(made)
    with guarded.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(made, maps.publish(made, examples.publication(made, survey_id)))
    return made


@contextmanager
def stream(guarded: Guarded, site_id: str, **options: Any) -> Iterator[ClientConnection]:
    url = f"ws://{guarded.client.base_url.netloc.decode()}/locate/stream?site_id={site_id}"
    with connect(url, open_timeout=OPEN_S, compression=None, **options) as socket:
        yield socket


def refused_with(guarded: Guarded, site_id: str, **options: Any) -> int:
    with pytest.raises(InvalidStatus) as refusal, stream(guarded, site_id, **options):
        pass
    return refusal.value.response.status_code


def session_cookie(guarded: Guarded) -> dict[str, str]:
    with guarded.anonymous() as browser:
        browser.post("/session", json={"key": guarded.new_key("locate")["secret"]})
        return {"Cookie": f"scattermark_session={browser.cookies['scattermark_session']}"}


def test_a_key_comes_as_header_or_as_subprotocol(guarded: Guarded, site_id: str) -> None:
    secret = guarded.new_key("locate", site_ids=[site_id])["secret"]
    with stream(guarded, site_id, additional_headers={"Authorization": f"Bearer {secret}"}) as socket:
        assert socket.subprotocol is None
    with stream(guarded, site_id, subprotocols=["scattermark", f"bearer.{secret}"]) as socket:
        assert socket.subprotocol == "scattermark"  # the secret does not come back
    with stream(guarded, site_id, subprotocols=[f"bearer.{secret}"]) as socket:
        assert socket.subprotocol == f"bearer.{secret}"  # browsers hang up when nothing they offered comes back


def test_a_browser_comes_with_its_cookie_from_here_alone(guarded: Guarded, site_id: str) -> None:
    cookie = session_cookie(guarded)
    own = f"http://{guarded.client.base_url.netloc.decode()}"
    with stream(guarded, site_id, additional_headers=cookie, origin=own):
        pass
    assert refused_with(guarded, site_id, additional_headers=cookie, origin="https://elsewhere.example") == 403


def test_without_a_key_scope_or_site_there_is_no_stream(guarded: Guarded, site_id: str) -> None:
    other = guarded.new_key("locate", site_ids=[guarded.new_site()])["secret"]
    wrong = guarded.new_key("survey")["secret"]
    assert refused_with(guarded, site_id) == 401
    assert refused_with(guarded, site_id, subprotocols=["bearer.smk_guessed"]) == 401
    assert refused_with(guarded, site_id, subprotocols=[f"bearer.{wrong}"]) == 403
    assert refused_with(guarded, site_id, subprotocols=[f"bearer.{other}"]) == 404
