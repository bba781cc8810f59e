"""A small client of the service: JSON over HTTP, with the problems it answers as errors."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http.client import HTTPConnection, HTTPException
from typing import Any
from urllib.parse import quote, urlencode, urlsplit

from app.errors import ScattermarkError

ANSWER_TIMEOUT_S = 60.0  # no single call takes longer: builds run in the background


class ServiceProblem(ScattermarkError):
    """A problem that the service answered (RFC 9457), or that it did not answer.

    ``fields`` holds the problem's own members, ``status`` among them.
    """

    slug = "service-problem"

    @property
    def kind(self) -> str:
        """Last part of the problem's type, such as ``not-located``."""
        return str(self.fields.get("type", "")).rstrip("/").rsplit("/", 1)[-1]


class ServiceClient:
    """One connection to a running service.

    Parameters
    ----------
    url : str
        Such as ``http://127.0.0.1:8000``.
    """

    def __init__(self, url: str) -> None:
        self._place = urlsplit(url)
        self._connection = HTTPConnection(self._place.netloc, timeout=ANSWER_TIMEOUT_S)

    def get(self, *path: str, **query: str) -> Any:
        """Answer of a GET; the parts of the path are quoted."""
        return self._call("GET", path, query)

    def post(self, *path: str, body: Any = None) -> Any:
        """Answer of a POST of JSON."""
        return self._call("POST", path, {}, None if body is None else json.dumps(body).encode(), "application/json")

    def put(self, *path: str, data: bytes, kind: str) -> Any:
        """Answer of a PUT of bytes of a media type."""
        return self._call("PUT", path, {}, data, kind)

    def send_photo(self, *path: str, data: bytes, **query: str) -> Any:
        """Answer of a POST of a photograph's bytes."""
        return self._call("POST", path, query, data, "application/octet-stream")

    def close(self) -> None:
        """End the connection."""
        self._connection.close()

    def _call(
        self, method: str, path: tuple[str, ...], query: Mapping[str, str], data: bytes | None = None, kind: str = ""
    ) -> Any:
        target = "/" + "/".join(quote(part, safe="") for part in path) + (f"?{urlencode(query)}" if query else "")
        headers = {"Content-Type": kind} if data is not None else {}
        try:
            self._connection.request(method, target, data, headers)
            response = self._connection.getresponse()
            body = response.read()
        except (OSError, HTTPException) as error:
            self._connection.close()  # the next call opens a new one
            raise ServiceProblem(f"{self._place.geturl()} gave no answer to {method} {target}: {error!r}") from error
        return _answer(f"{method} {target}", response.status, body)


def _answer(call: str, status: int, body: bytes) -> Any:
    try:
        record = json.loads(body) if body else None
    except ValueError:
        record = None
    if status >= 400:
        members = record if isinstance(record, dict) else {}
        detail = members.get("detail") or members.get("title") or f"status {status}"
        members = {name: value for name, value in members.items() if name != "detail"}
        raise ServiceProblem(f"{call}: {detail}", **{**members, "status": status})
    return record
