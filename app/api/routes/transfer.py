"""Whole sites out of this installation and into it."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import StreamingResponse
from starlette.requests import ClientDisconnect

from app.api.dependencies import PathId, Running
from app.api.problems import problems
from app.api.schemas.transfer import ARCHIVE, ARCHIVE_BODY, ARCHIVE_CONTENT, ImportedSiteAnswer
from app.api.security import needs
from app.storage.archive_format import BadArchive

router = APIRouter(tags=["sites"])
import_router = APIRouter(tags=["sites"])


@router.get(
    "/sites/{site_id}/export",
    dependencies=[needs("admin")],
    response_class=StreamingResponse,
    responses={200: {"description": "The site's archive.", "content": ARCHIVE_CONTENT}, **problems(404, 422, 503)},
)
def export_site(site_id: PathId, services: Running) -> StreamingResponse:
    """One site with its control points, surveys, photographs, detections, maps, cameras and trajectories."""
    headers = {"Content-Disposition": f'attachment; filename="site-{site_id}.zip"'}
    return StreamingResponse(services.transfers.export(site_id), media_type=ARCHIVE, headers=headers)


@import_router.post(
    "/sites/import",
    status_code=201,
    dependencies=[needs("admin")],
    responses=problems(409, 413, 422, 503, 507),
    openapi_extra={"requestBody": ARCHIVE_BODY},
)
async def import_site(
    request: Request,
    services: Running,
    as_new: Annotated[bool, Query(description="Give the site and all that belongs to it new ids.")] = False,
) -> ImportedSiteAnswer:
    """Take in a site that was exported elsewhere, as raw body; all of it or nothing."""
    return ImportedSiteAnswer.of(await services.transfers.take(_chunks(request), as_new=as_new))


async def _chunks(request: Request) -> AsyncIterator[bytes]:
    try:
        async for chunk in request.stream():
            yield chunk
    except ClientDisconnect as error:
        raise BadArchive("the upload broke off; send the archive again") from error
