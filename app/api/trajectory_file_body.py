"""A trajectory's file comes as the raw body with its parameters in the query, or as a form."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from pydantic import ValidationError
from starlette.datastructures import FormData, UploadFile
from starlette.requests import ClientDisconnect

from app.api.schemas.trajectory_import import ImportParameters
from app.api.uploads import chunks_of_file
from app.errors import InvalidInput
from app.services.trajectory_import import ArrivingFile, Chunks

FORM_TYPE = "multipart/form-data"
POSES, TIMES = "file", "times"
TEXT_TYPES = ("text/csv", "text/plain", "application/geo+json", "application/octet-stream")


@dataclass(frozen=True)
class SentFile:
    """A file, and what its client says of it."""

    parameters: ImportParameters
    arriving: ArrivingFile


@asynccontextmanager
async def sent_file(request: Request) -> AsyncIterator[SentFile]:
    """The file of a request, which is there until the block ends.

    Raises
    ------
    RequestValidationError
        When a parameter or the file is missing or malformed.
    """
    if not request.headers.get("content-type", "").lower().startswith(FORM_TYPE):
        parameters = _checked(dict(request.query_params), "query")
        yield SentFile(parameters, ArrivingFile(_chunks_of_body(request)))
        return
    try:
        form = await request.form(max_files=2)
    except ClientDisconnect as error:
        raise _broken_off() from error
    async with _closing(form):
        fields = {name: value for name, value in form.items() if isinstance(value, str)}
        parameters = _checked({**request.query_params, **fields}, "body")
        poses = _chunks_of_part(form, POSES)
        if poses is None:
            problem = {"type": "missing", "loc": ("body", POSES), "msg": "the trajectory is missing: send it as a file"}
            raise RequestValidationError([problem])
        yield SentFile(parameters, ArrivingFile(poses, _chunks_of_part(form, TIMES)))


@asynccontextmanager
async def _closing(form: FormData) -> AsyncIterator[None]:
    try:
        yield
    finally:
        await form.close()


def _checked(fields: dict[str, Any], place: str) -> ImportParameters:
    given = {name: value for name, value in fields.items() if value != ""}  # an empty field of a form is none
    try:
        return ImportParameters.model_validate(given)
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False, include_input=False)
        raise RequestValidationError([{**item, "loc": (place, *item["loc"])} for item in found]) from error


def _chunks_of_part(form: FormData, name: str) -> Chunks | None:
    part = form.get(name)
    return chunks_of_file(part) if isinstance(part, UploadFile) else None


async def _chunks_of_body(request: Request) -> AsyncIterator[bytes]:
    try:
        async for chunk in request.stream():
            yield chunk
    except ClientDisconnect as error:
        raise _broken_off() from error


def _broken_off() -> InvalidInput:
    return InvalidInput("the upload broke off; send the trajectory again")


def import_openapi() -> dict[str, Any]:
    """OpenAPI's word on the two ways."""
    schema = ImportParameters.model_json_schema()
    properties = {name: _never_null(value) for name, value in schema["properties"].items()}
    file = {"type": "string", "format": "binary"}
    form = {
        "type": "object",
        "properties": {POSES: file, TIMES: {**file, "description": "KITTI's times.txt."}, **properties},
        "required": [POSES, *schema["required"]],
    }
    texts = {media_type: {"schema": file} for media_type in TEXT_TYPES}
    parameters = [
        {"in": "query", "name": name, "schema": value, "required": False} for name, value in properties.items()
    ]
    body = {"required": True, "content": {FORM_TYPE: {"schema": form}, **texts}}
    return {"requestBody": body, "parameters": parameters}


def _never_null(schema: dict[str, Any]) -> dict[str, Any]:
    """A field of a form or of a query is there or not: it is never null."""
    options = [option for option in schema.get("anyOf", []) if option != {"type": "null"}]
    if len(options) != 1:
        return schema
    return {**options[0], **{name: value for name, value in schema.items() if name not in ("anyOf", "default")}}
