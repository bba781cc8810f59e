"""Who asks, found out before anything of a body is read: nobody without a key fills a disk with an upload.

The framework reads a form or a JSON body before it asks a route's dependencies.
"""

from __future__ import annotations

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.credentials import address_of, credentials_of
from app.api.problems import known_problem_response
from app.errors import ScattermarkError
from app.services.gatekeeper import Gatekeeper
from app.services.principal import Principal

WITHOUT_BODY = ("GET", "HEAD", "OPTIONS")
FOR_VISITORS = ("/session",)  # whoever has only a key to show, and shows it in the body
PRINCIPAL = "principal"  # of the connection's state


class AdmittedOnly:
    """Answers requests with a body by a problem unless their key is valid and asks no more often than it may."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] == "http" and scope["method"] not in WITHOUT_BODY and scope["path"] not in FOR_VISITORS:
            connection = HTTPConnection(scope)
            try:
                setattr(connection.state, PRINCIPAL, await admitted(connection))
            except ScattermarkError as refusal:
                await known_problem_response(refusal)(scope, receive, send)
                return
        await self._app(scope, receive, send)


async def admitted(connection: HTTPConnection) -> Principal:
    """Who asks, counted and not yet asked what for: for each frame of a WebSocket after its handshake.

    Raises
    ------
    NotAuthenticated, TooManyRequests
    """
    return await gatekeeper_of(connection).admit(credentials_of(connection), address_of(connection))


def principal_of_state(connection: HTTPConnection) -> Principal | None:
    """Whoever was admitted before the body was read."""
    return getattr(connection.state, PRINCIPAL, None)


def gatekeeper_of(connection: HTTPConnection) -> Gatekeeper:
    """Who admits."""
    gatekeeper = connection.state.services.gatekeeper
    assert isinstance(gatekeeper, Gatekeeper)
    return gatekeeper
