"""A snapshot's pose."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Response, WebSocket

from app.api.dependencies import Running
from app.api.locate_body import locate_openapi, locate_request
from app.api.locate_stream import answer_stream
from app.api.problems import problems
from app.api.schemas.locate import LocateAnswer
from app.api.security import Locating
from app.services.locate import LocateRequest

JSON = "application/json"

router = APIRouter(tags=["locate"])


@router.post(
    "/locate",
    response_model=LocateAnswer,
    responses=problems(400, 404, 409, 413, 415, 422, 500, 503, 504),
    openapi_extra=locate_openapi(),
)
async def locate(request: Annotated[LocateRequest, Depends(locate_request)], services: Running) -> Response:
    """Where a snapshot was taken; 422 with reason and advice when no pose can be trusted."""
    answer = LocateAnswer.of(await services.locator.locate(request))
    # Written here and now: the framework would check a second time what was checked when it was made.
    return Response(answer.model_dump_json(), media_type=JSON)


@router.websocket("/locate/stream")
async def locate_stream(websocket: WebSocket, principal: Locating) -> None:
    """A frame per binary message in, one answer per frame out, newest first (``app.api.locate_stream``)."""
    await answer_stream(websocket, principal, websocket.state.services.locator)
