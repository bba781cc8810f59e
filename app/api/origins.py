"""Pages of other sites are kept out: a browser sends requests for any page, to this machine as well.

Without keys, a page could rename itself to this machine (DNS rebinding): the ``Host`` must then be a name that this
machine is known by. A page that changes something says where it is from (``Origin``, ``Sec-Fetch-Site``): from here, or
from an origin that the operator named. Whoever shows a key is not a page that has none.
"""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.credentials import key_of
from app.api.problems import kind_of, problem_of, problem_response
from app.api.request_id import HEADER
from app.errors import NotAllowed
from app.settings import Settings

SAFE_METHODS = ("GET", "HEAD", "OPTIONS")
FOREIGN_SITES = ("cross-site", "same-site")  # of Sec-Fetch-Site; the others are from here, or typed by a person


@dataclass(frozen=True)
class TrustedPages:
    """Which names and origins are this service's own, or as good as.

    Attributes
    ----------
    check_host : bool
        Whether ``Host`` must be a name of this machine or one of ``hosts``.
    hosts : tuple of str
        Names, without ports.
    origins : tuple of str
        Such as ``https://maps.example.org``.
    """

    check_host: bool
    hosts: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()

    def refusal(self, connection: HTTPConnection) -> str | None:
        """Why a request is refused, or None."""
        host = connection.headers.get("host")
        if self.check_host and host is not None and not self._is_known(host):
            return f"this service is not called {host[:100]}; name it in SCATTERMARK_ALLOWED_HOSTS if it is"
        if not _changes_something(connection.scope) or key_of(connection) is not None:
            return None
        if self._is_from_elsewhere(connection):
            return "this request comes from a page of another origin; name it in SCATTERMARK_CORS_ORIGINS if it may"
        return None

    def _is_known(self, host: str) -> bool:
        name = _name_of(host)
        return is_loopback_name(name) or name in self.hosts

    def _is_from_elsewhere(self, connection: HTTPConnection) -> bool:
        origin = connection.headers.get("origin")
        if origin is None:
            return connection.headers.get("sec-fetch-site") in FOREIGN_SITES
        if origin in self.origins:
            return False
        page = urlsplit(origin)
        # Behind a proxy that speaks TLS the service itself is called by http; the other way round never.
        secure_enough = page.scheme == "https" or connection.url.scheme in ("http", "ws")
        own = page.netloc.lower() == connection.headers.get("host", "").lower() or page.hostname in self.hosts
        return not (page.netloc and own and secure_enough)


def trusted_pages(settings: Settings) -> TrustedPages:
    """Whom an installation with these settings trusts; the name is checked where neither keys nor the network are."""
    open_here = not settings.require_keys and not settings.insecure
    return TrustedPages(open_here or bool(settings.host_names), settings.host_names, settings.page_origins)


def cors_rules(origins: tuple[str, ...]) -> dict[str, Any]:
    """What pages of these origins may do: all that a key lets them, and never with a cookie."""
    return {
        "allow_origins": origins,
        "allow_methods": ["GET", "POST", "PUT", "PATCH", "DELETE"],
        "allow_headers": ["Authorization", "Content-Type", "Last-Event-ID", HEADER],
        "expose_headers": ["Retry-After", HEADER],
    }


class TrustedPagesOnly:
    """Answers requests of other pages with a problem.

    Parameters
    ----------
    app : ASGIApp
    trusted : TrustedPages
    """

    def __init__(self, app: ASGIApp, trusted: TrustedPages) -> None:
        self._app = app
        self._trusted = trusted

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        refusal = self._trusted.refusal(HTTPConnection(scope)) if scope["type"] in ("http", "websocket") else None
        if refusal is None:
            await self._app(scope, receive, send)
            return
        problem = problem_of(NotAllowed.slug, kind_of(NotAllowed), refusal, {})
        await problem_response(problem)(scope, receive, send)


def is_loopback_name(name: str) -> bool:
    """Whether a name always means the machine that says it."""
    if name == "localhost" or name.endswith(".localhost"):  # RFC 6761, section 6.3
        return True
    try:
        return ipaddress.ip_address(name).is_loopback
    except ValueError:
        return False


def _name_of(host: str) -> str:
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def _changes_something(scope: Scope) -> bool:
    return scope["type"] == "websocket" or scope["method"] not in SAFE_METHODS
