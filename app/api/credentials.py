"""Where a request carries its key: a header, the cookie of a session, or a WebSocket's subprotocol."""

from __future__ import annotations

from fastapi import WebSocket
from fastapi.openapi.models import APIKey, APIKeyIn, HTTPBearer
from fastapi.security.base import SecurityBase
from starlette.requests import HTTPConnection

from app.services.gatekeeper import Credentials

COOKIE = "scattermark_session"
SCHEME = "bearer "
SUBPROTOCOL = "scattermark"  # what a browser offers beside the one with the key, and what it is answered
KEY_SUBPROTOCOL = "bearer."
UNKNOWN_ADDRESS = "unknown"  # of a client behind a Unix socket


class KeyInHeader(SecurityBase):
    """A key as ``Authorization: Bearer``; browsers, which cannot set it on WebSockets, name it as a subprotocol."""

    def __init__(self) -> None:
        self.model = HTTPBearer(description="A key: `scattermark keys create` makes one.")
        self.scheme_name = "key"

    async def __call__(self, connection: HTTPConnection) -> str | None:
        """The key that is shown."""
        return key_of(connection)


class CookieOfSession(SecurityBase):
    """The cookie that ``POST /session`` gives for a key."""

    def __init__(self) -> None:
        self.model = APIKey.model_validate(
            {"in": APIKeyIn.cookie, "name": COOKIE, "description": "For browsers: POST /session gives it for a key."}
        )
        self.scheme_name = "session"

    async def __call__(self, connection: HTTPConnection) -> str | None:
        """The cookie that is shown."""
        return connection.cookies.get(COOKIE)


def key_of(connection: HTTPConnection) -> str | None:
    """The key of a request or of a WebSocket's handshake."""
    authorization = connection.headers.get("authorization", "")
    if authorization[: len(SCHEME)].lower() == SCHEME:
        return authorization[len(SCHEME) :].strip()
    if connection.scope["type"] == "websocket":
        offered = [name for name in _subprotocols(connection) if name.startswith(KEY_SUBPROTOCOL)]
        return offered[0][len(KEY_SUBPROTOCOL) :] if offered else None
    return None


def credentials_of(connection: HTTPConnection) -> Credentials:
    """All that a request shows."""
    return Credentials(key_of(connection), connection.cookies.get(COOKIE))


def address_of(connection: HTTPConnection) -> str:
    """Where a request comes from; behind a proxy that is trusted, where the proxy says."""
    return UNKNOWN_ADDRESS if connection.client is None else connection.client.host


def answered_subprotocol(websocket: WebSocket) -> str | None:
    """What ``websocket.accept(subprotocol=...)`` answers: browsers hang up when nothing they offered comes back."""
    offered = _subprotocols(websocket)
    return SUBPROTOCOL if SUBPROTOCOL in offered else next(iter(offered), None)


def _subprotocols(connection: HTTPConnection) -> list[str]:
    return list(connection.scope.get("subprotocols", []))
