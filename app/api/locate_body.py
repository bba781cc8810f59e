"""A snapshot comes as a form, or as the raw body with its parameters in the query."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from pydantic import ValidationError
from starlette.datastructures import FormData, UploadFile
from starlette.requests import ClientDisconnect

from app.api.schemas.locate import LocateParameters
from app.api.security import Locating
from app.api.uploads import IMAGE_BODY
from app.errors import BadPhoto
from app.services.locate import LocateRequest

FORM_TYPE = "multipart/form-data"


async def locate_request(request: Request, principal: Locating) -> LocateRequest:
    """The snapshot of a request.

    Raises
    ------
    NotFound
        When its site is none of the key's.
    RequestValidationError
        When a parameter or the image is missing or malformed.
    """
    content_type = request.headers.get("content-type", "").lower()
    try:
        if content_type.startswith(FORM_TYPE):
            async with request.form(max_files=1) as form:
                part = await _form_part(request, form)
        else:
            part = _Part(await request.body(), dict(request.query_params), "query")
    except ClientDisconnect as error:
        raise BadPhoto("the upload broke off; send the snapshot again") from error
    parameters = checked_parameters(part.fields, part.place)
    principal.site(parameters.site_id)
    return parameters.to_domain(part.photo)


@dataclass(frozen=True)
class _Part:
    """An image, its parameters, and where they stood."""

    photo: bytes
    fields: dict[str, Any]
    place: str


async def _form_part(request: Request, form: FormData) -> _Part:
    image = form.get("image")
    if not isinstance(image, UploadFile):
        problem = {"type": "missing", "loc": ("body", "image"), "msg": "the photograph is missing: send it as a file"}
        raise RequestValidationError([problem])
    fields = {name: value for name, value in form.items() if name != "image"}
    return _Part(await image.read(), {**request.query_params, **fields}, "body")


def checked_parameters(fields: dict[str, Any], place: str) -> LocateParameters:
    """What a client says of a snapshot; ``place`` is where it said so.

    Raises
    ------
    RequestValidationError
    """
    given = {name: value for name, value in fields.items() if value != ""}  # an empty field of a form is none
    try:
        return LocateParameters.model_validate(given)
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False, include_input=False)
        raise RequestValidationError([{**item, "loc": (place, *item["loc"])} for item in found]) from error


def locate_openapi() -> dict[str, Any]:
    """OpenAPI's word on the two ways."""
    schema = LocateParameters.model_json_schema(ref_template="#/components/schemas/{model}")
    definitions, required = schema.pop("$defs", {}), schema["required"]
    properties = {name: _as_text(_inline(value, definitions)) for name, value in schema["properties"].items()}
    form = {
        "type": "object",
        "properties": {"image": {"type": "string", "format": "binary"}, **properties},
        "required": ["image", *required],
    }
    parameters = [
        {
            "in": "query",
            "name": name,
            "schema": value,
            "required": False,
            "description": "With a raw body; fields of the form otherwise." + value.get("description", ""),
        }
        for name, value in properties.items()
    ]
    body = {"required": True, "content": {FORM_TYPE: {"schema": form}, **IMAGE_BODY["content"]}}
    return {"requestBody": body, "parameters": parameters}


def _as_text(schema: dict[str, Any]) -> dict[str, Any]:
    """A field of a form or of a query is there or not: it is never null."""
    options = [option for option in schema.get("anyOf", []) if option != {"type": "null"}]
    if len(options) != 1:
        return schema
    return {**options[0], **{name: value for name, value in schema.items() if name not in ("anyOf", "default")}}


def _inline(schema: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    """A JSON-encoded field travels as text; its schema tells what the text holds."""
    if any("contentSchema" in option for option in [schema, *schema.get("anyOf", [])]) or not definitions:
        return {"type": "string", "description": "JSON: width_px, height_px, fx, fy, cx, cy, dist, readout_s"}
    return schema
