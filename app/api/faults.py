"""A fault of ours becomes a problem with the request's id: the log has the rest under the same id.

The framework would answer outside of all middlewares: without the request's id and the headers that every answer has.
"""

from __future__ import annotations

import asyncio
import logging

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.problems import fault_problem, problem_response, stopped_problem

log = logging.getLogger(__name__)

INTERNAL_ERROR = 1011  # RFC 6455, 7.4.1
RETRY_AFTER_S = 5  # a server starts in about so many seconds


class FaultsAsProblems:
    """Answers what no handler knew."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or carry on one socket."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        started = False

        async def watched(message: Message) -> None:
            nonlocal started
            started = started or message["type"] in ("http.response.start", "websocket.close")
            await send(message)

        try:
            await self._app(scope, receive, watched)
        except asyncio.CancelledError:  # the server stops and waits no longer
            if scope["type"] == "http" and not started:
                await problem_response(stopped_problem(), {"Retry-After": str(RETRY_AFTER_S)})(scope, receive, send)
            raise
        except Exception:
            log.exception("unexpected error")
            if started:
                raise  # half an answer must not look like a whole one: the server breaks the connection
            if scope["type"] == "websocket":
                await send({"type": "websocket.close", "code": INTERNAL_ERROR})
            else:
                await problem_response(fault_problem())(scope, receive, send)
