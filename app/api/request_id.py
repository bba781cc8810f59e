"""One id per request: taken from ``X-Request-ID`` or made, sent back, in every log line and in every problem."""

from __future__ import annotations

import re

from asgi_correlation_id import CorrelationIdMiddleware, correlation_id
from starlette.types import ASGIApp

HEADER = "X-Request-ID"
# What clients and proxies send: UUIDs, hex, trace ids. Nothing that could be mistaken for more than one word of a log.
ACCEPTED = re.compile(r"[A-Za-z0-9._-]{1,64}")


class RequestIds(CorrelationIdMiddleware):
    """Binds an id to each request; one that is no plain word is replaced."""

    def __init__(self, app: ASGIApp) -> None:
        super().__init__(app, header_name=HEADER, validator=is_request_id)


def is_request_id(text: str) -> bool:
    """Whether a client's id is taken as it is."""
    return ACCEPTED.fullmatch(text) is not None


def present_request_id() -> str | None:
    """The id of the request that is being answered; None outside of one."""
    return correlation_id.get()
