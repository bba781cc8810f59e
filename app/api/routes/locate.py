"""A snapshot's pose."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends

from app.api.dependencies import Running
from app.api.locate_body import locate_openapi, locate_request
from app.api.problems import problems
from app.api.schemas.locate import LocateAnswer
from app.services.locate import LocateRequest

router = APIRouter(tags=["locate"])


@router.post("/locate", responses=problems(400, 404, 409, 413, 415, 422, 500, 503, 504), openapi_extra=locate_openapi())
async def locate(request: Annotated[LocateRequest, Depends(locate_request)], services: Running) -> LocateAnswer:
    """Where a snapshot was taken; 422 with reason and advice when no pose can be trusted."""
    return LocateAnswer.of(await services.locator.locate(request))
