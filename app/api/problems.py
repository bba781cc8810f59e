"""Errors as RFC 9457 problems: the one table that gives each kind of error its status."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException

from app import errors
from app.api.allowed_methods import allowed_methods
from app.api.request_id import present_request_id
from app.storage.objects import FULL

log = logging.getLogger(__name__)

TYPE_ROOT = "https://scattermark.dev/problems/"
MEDIA_TYPE = "application/problem+json"
MEMBERS = ("type", "title", "status", "detail")
ERRORS_SHOWN = 5  # in the text
ERRORS_TOLD = 100  # in the fields: who has more begins with these
FIELD_CHARACTERS = 200  # of a field's name, which may be anything
METHOD_NOT_ALLOWED = 405
# The framework writes a form's files aside, and calls a full disk a request that cannot be read.
FULL_SPOOL = (
    "the server's disk for forms on their way in (TMPDIR) is full; make room on it, or send photographs one by one as "
    "raw bodies (PUT), which take less"
)
SLOW_BODY = (408, 503)
CHALLENGE = 'Bearer realm="scattermark"'  # RFC 6750, section 3


@dataclass(frozen=True)
class Kind:
    """How one kind of error is answered."""

    status: int
    title: str


TABLE: dict[type[errors.ScattermarkError], Kind] = {
    errors.InvalidInput: Kind(422, "Invalid input"),
    errors.InvalidControlPoints: Kind(422, "Unusable control points"),
    errors.BadPhoto: Kind(415, "Not a readable photograph"),
    errors.UnsupportedPhoto: Kind(415, "Unsupported kind of image"),
    errors.PhotoTooLarge: Kind(413, "Photograph too large"),
    errors.NotAuthenticated: Kind(401, "Key needed"),
    errors.NotAllowed: Kind(403, "Not allowed"),
    errors.TooManyRequests: Kind(429, "Too many requests"),
    errors.NotFound: Kind(404, "Not found"),
    errors.Conflict: Kind(409, "Conflict"),
    errors.DegenerateGeometry: Kind(422, "Degenerate geometry"),
    errors.SurveyFailed: Kind(422, "Survey cannot be adjusted"),
    errors.CalibrationFailed: Kind(422, "Camera cannot be calibrated"),
    errors.NotLocated: Kind(422, "Not located"),
    errors.Cancelled: Kind(503, "Cancelled"),
    errors.ServerFull: Kind(503, "Server full"),
    errors.FrameDropped: Kind(503, "Frame dropped"),
    errors.TimedOut: Kind(504, "Time limit exceeded"),
    errors.SheetUnreadable: Kind(500, "Sheet unreadable"),
    errors.WorkerCrashed: Kind(500, "Worker crashed"),
    errors.OutOfMemory: Kind(503, "Out of memory"),
    errors.StorageUnavailable: Kind(503, "Storage unavailable"),
    errors.OutOfSpace: Kind(507, "Insufficient storage"),
    errors.ScattermarkError: Kind(500, "Error"),
}

HTTP_PROBLEMS: dict[int, tuple[str, str, str]] = {
    400: ("bad-request", "Bad request", "the request cannot be read ({detail}); /docs shows what is expected"),
    404: ("not-found", "Not found", "there is nothing at {path}; /docs lists the calls"),
    405: ("method-not-allowed", "Method not allowed", "{path} does not take {method}; /docs lists the calls"),
    406: ("not-acceptable", "Not acceptable", "{detail}"),
    408: ("too-slow", "Request too slow", "{detail}; send the request again, over a faster connection if there is one"),
    413: ("too-large", "Request too large", "the request is larger than this call takes; send less at a time"),
    415: ("unsupported-media-type", "Unsupported media type", "{detail}"),
    503: ("server-full", "Server full", "{detail}"),
}


class Problem(BaseModel):
    """A problem as RFC 9457 has it; each type may add its own members."""

    model_config = ConfigDict(extra="allow")

    type: str = Field(examples=[TYPE_ROOT + "not-found"])
    title: str
    status: int
    detail: str = Field(description="What happened and what to do about it.")
    request_id: str = Field(default="", description="What to name when it is reported: the log has it, too.")


def problem_of(slug: str, kind: Kind, detail: str, fields: dict[str, Any]) -> dict[str, Any]:
    """A problem as JSON; an error's fields become members of their own."""
    members = {name: value for name, value in fields.items() if name not in MEMBERS}
    return {"type": TYPE_ROOT + slug, "title": kind.title, "status": kind.status, "detail": detail, **members}


def kind_of(error_type: type[errors.ScattermarkError]) -> Kind:
    """The row of the table for an error, or for its nearest ancestor."""
    return next(TABLE[ancestor] for ancestor in error_type.__mro__ if ancestor in TABLE)


def kind_of_slug(slug: str) -> Kind:
    """The row of the table for an error that was stored by its slug."""
    return next((kind for error_type, kind in TABLE.items() if error_type.slug == slug), TABLE[errors.ScattermarkError])


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI's word on the problems a call can answer with."""
    titles = {status: title for status, (_, title, _) in HTTP_PROBLEMS.items()}
    titles.update({kind.status: kind.title for kind in reversed(TABLE.values())})
    content = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    return {status: {"description": titles.get(status, "Problem"), "content": content} for status in statuses}


def describe_slow_bodies(document: dict[str, Any]) -> None:
    """Say of each call with a body that it may come too slowly."""
    for operations in document["paths"].values():
        for operation in operations.values():
            if "requestBody" in operation:
                for status, answer in problems(*SLOW_BODY).items():
                    operation["responses"].setdefault(str(status), answer)


def add_handlers(app: FastAPI) -> None:
    """Answer every error with a problem."""
    app.add_exception_handler(errors.ScattermarkError, _on_known_error)
    app.add_exception_handler(RequestValidationError, _on_validation_error)
    app.add_exception_handler(HTTPException, _on_http_error)


def http_problem(status: int, path: str, method: str, detail: str) -> dict[str, Any]:
    """A problem that the framework found before any service was asked."""
    slug, title, text = HTTP_PROBLEMS.get(status, ("http-error", "Error", "{detail}"))
    return problem_of(slug, Kind(status, title), text.format(path=path, method=method, detail=detail), {})


def fault_problem() -> dict[str, Any]:
    """A problem for an error that nobody expected: all that is said of it is how to find it in the log."""
    detail = "a fault of the server; try again, and report request_id if it stays so"
    return problem_of("fault", Kind(500, "Internal error"), detail, {})


def stopped_problem() -> dict[str, Any]:
    """A problem for a request that the server could not finish before it had to stop."""
    detail = "the server stopped before this was done; send the request again"
    return problem_of("stopped", Kind(503, "Server stopped"), detail, {})


def problem_response(problem: dict[str, Any], headers: dict[str, str] | None = None) -> JSONResponse:
    """The answer that carries a problem and the id of the request that met it."""
    return JSONResponse(identified(problem), status_code=problem["status"], media_type=MEDIA_TYPE, headers=headers)


def identified(problem: dict[str, Any]) -> dict[str, Any]:
    """A problem with the id of the request that met it."""
    request_id = present_request_id()
    return problem if request_id is None else {**problem, "request_id": request_id}


def known_problem(error: errors.ScattermarkError) -> dict[str, Any]:
    """The problem of an error that was raised on purpose."""
    kind = kind_of(type(error))
    if kind.status == 500:
        log.error("%s: %s", error.slug, error.detail)
    return problem_of(error.slug, kind, error.detail, error.fields)


def known_problem_response(error: errors.ScattermarkError) -> JSONResponse:
    """The answer for an error that was raised on purpose."""
    return problem_response(known_problem(error), _headers_of(error))


def invalid_problem(error: RequestValidationError) -> dict[str, Any]:
    """The problem of a request that does not fit its call."""
    found = [
        {"field": ".".join(str(part) for part in item["loc"])[:FIELD_CHARACTERS], "problem": item["msg"]}
        for item in error.errors()[:ERRORS_TOLD]
    ]
    shown = "; ".join(f"{item['field']}: {item['problem']}" for item in found[:ERRORS_SHOWN])
    detail = f"the request does not fit this call ({shown}); correct it, /docs shows what is expected"
    return problem_of("invalid-input", TABLE[errors.InvalidInput], detail, {"errors": found})


async def _on_known_error(_request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, errors.ScattermarkError)
    return known_problem_response(error)


def _headers_of(error: errors.ScattermarkError) -> dict[str, str]:
    headers = {}
    if "retry_after_s" in error.fields:
        headers["Retry-After"] = str(error.fields["retry_after_s"])
    if isinstance(error, errors.NotAuthenticated):
        headers["WWW-Authenticate"] = CHALLENGE
    return headers


async def _on_validation_error(_request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    return problem_response(invalid_problem(error))


async def _on_http_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    if isinstance(error.__cause__, OSError) and error.__cause__.errno in FULL:
        return known_problem_response(errors.OutOfSpace(FULL_SPOOL))
    problem = http_problem(error.status_code, request.url.path, request.method, error.detail)
    headers = dict(error.headers or {})
    if error.status_code == METHOD_NOT_ALLOWED:
        headers["Allow"] = allowed_methods(request.app.routes, request.url.path)
    return problem_response(problem, headers)
