"""Photographs on their way in, chunk by chunk; what breaks off half-way is an error, never a short photograph."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import UploadFile
from starlette.requests import ClientDisconnect

from app.api.content_digest import announced_sha256
from app.errors import BadPhoto
from app.services.surveys import Upload

CHUNK_BYTES = 2**18  # few enough to be cheap, small enough to keep many uploads in memory

IMAGE_BODY: dict[str, Any] = {
    "required": True,
    "content": {
        media_type: {"schema": {"type": "string", "format": "binary"}}
        for media_type in ("image/jpeg", "image/png", "image/webp", "image/heic", "application/octet-stream")
    },
}


def upload_of_body(filename: str, request: Request, sha256: Annotated[str | None, Depends(announced_sha256)]) -> Upload:
    """The photograph that a request's body is, with what its headers announce of it."""
    length = request.headers.get("content-length", "")
    size_bytes = int(length) if length.isascii() and length.isdigit() else 0
    return Upload(filename, chunks_of_body(request), size_bytes, sha256)


async def chunks_of_body(request: Request) -> AsyncIterator[bytes]:
    """The request's body as it arrives.

    Raises
    ------
    BadPhoto
        When the client leaves before the end.
    """
    try:
        async for chunk in request.stream():
            yield chunk
    except ClientDisconnect as error:
        raise BadPhoto("the upload broke off; send the photograph again") from error


async def chunks_of_file(file: UploadFile) -> AsyncIterator[bytes]:
    """A form's file, which has arrived already."""
    while chunk := await file.read(CHUNK_BYTES):
        yield chunk
