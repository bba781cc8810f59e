"""Each request counted and logged: route, status, time and size, and no more of what was in it."""

from __future__ import annotations

import logging
import time
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.admission import PRINCIPAL
from app.api.http_metrics import OTHER, HttpMetrics
from app.api.streams import is_event_stream

log = logging.getLogger(__name__)

CLIENT_LEFT = 499  # nginx's number for a client that did not wait
FAULT = 500
MS_PER_S = 1000.0
# Asked every few seconds by machines; who wants to see them says SCATTERMARK_LOG_LEVEL=debug.
PROBES = frozenset({"/healthz", "/readyz", "/metrics"})
ID_SUFFIX = "_id"
ID_CHARACTERS = 40  # a UUID has 36; whatever else stands in a path is not worth a longer line


class Observed:
    """Measures what passes; the outermost but for the request's id."""

    def __init__(self, app: ASGIApp, metrics: HttpMetrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request, or carry on one socket."""
        if scope["type"] == "http":
            await self._answer(scope, receive, send)
        elif scope["type"] == "websocket":
            with self._metrics.sockets.track_inprogress():
                await self._app(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        answer = _Answer(send)
        with self._metrics.in_flight.track_inprogress():
            try:
                await self._app(scope, receive, answer.send)
            except Exception:
                answer.status = FAULT
                raise
            finally:
                duration_s = answer.duration_s()
                route = getattr(scope.get("route"), "path_format", OTHER)
                self._metrics.answered(scope["method"], route, answer.status, duration_s)
                _log(scope, route, answer, duration_s)


class _Answer:
    """One answer on its way out."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self._began_s = time.perf_counter()
        self._stream_after_s: float | None = None
        self.status = CLIENT_LEFT  # until there is another
        self.sent_bytes = 0

    async def send(self, message: Message) -> None:
        """Pass a part of the answer on."""
        if message["type"] == "http.response.start":
            self.status = message["status"]
            if is_event_stream(message):
                self._stream_after_s = time.perf_counter() - self._began_s
        else:
            self.sent_bytes += len(message.get("body", b""))
        await self._send(message)

    def duration_s(self) -> float:
        """How long the answer took; a stream lasts as long as its reader likes, so its beginning counts."""
        return time.perf_counter() - self._began_s if self._stream_after_s is None else self._stream_after_s


def _log(scope: Scope, route: str, answer: _Answer, duration_s: float) -> None:
    level = logging.DEBUG if route in PROBES else logging.INFO
    if not log.isEnabledFor(level):
        return
    facts: dict[str, Any] = {
        "method": scope["method"],
        "route": route,
        "status": answer.status,
        "duration_ms": round(MS_PER_S * duration_s, 2),
        "bytes": answer.sent_bytes,
        **{name: str(value)[:ID_CHARACTERS] for name, value in _ids(scope).items()},
    }
    key_id = getattr(scope.get("state", {}).get(PRINCIPAL), "key_id", None)
    log.log(level, "request", extra=facts if key_id is None else {**facts, "key_id": key_id})


def _ids(scope: Scope) -> dict[str, Any]:
    """The ids in the path; a file's name is nobody's business."""
    return {name: value for name, value in scope.get("path_params", {}).items() if name.endswith(ID_SUFFIX)}
