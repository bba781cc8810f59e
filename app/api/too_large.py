"""Requests over their size limit get a problem like all others: the framework's limiter answers in plain text."""

from __future__ import annotations

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.problems import MEDIA_TYPE, http_problem, problem_response

TOO_LARGE = 413


class TooLargeAsProblem:
    """Puts a problem in the place of a plain 413."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        replaced = False

        async def send_or_replace(message: Message) -> None:
            nonlocal replaced
            if message["type"] == "http.response.start" and _is_plain_refusal(message):
                replaced = True
                answer = problem_response(http_problem(TOO_LARGE, scope["path"], scope["method"], ""))
                await answer(scope, receive, send)
            elif not replaced:
                await send(message)

        await self._app(scope, receive, send_or_replace)


def _is_plain_refusal(start: Message) -> bool:
    kinds = [value for name, value in start["headers"] if name == b"content-type"]
    return start["status"] == TOO_LARGE and kinds != [MEDIA_TYPE.encode()]
