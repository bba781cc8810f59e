"""Sessions of browsers: a key for a cookie."""

from __future__ import annotations

from fastapi import APIRouter, Depends, Request, Response

from app.api.admission import admitted
from app.api.credentials import COOKIE
from app.api.dependencies import Running
from app.api.problems import problems
from app.api.schemas.keys import PrincipalAnswer, SessionAnswer, ShownKeyBody
from app.api.security import visitor

router = APIRouter(tags=["session"], prefix="/session")

UNSEEN = {"Cache-Control": "no-store"}


@router.post("", status_code=201, responses=problems(400, 401, 403, 413, 422, 429), dependencies=[Depends(visitor)])
async def open_session(body: ShownKeyBody, request: Request, response: Response, services: Running) -> SessionAnswer:
    """Exchange a key for a cookie that no script can read; it ends by itself after a fixed time."""
    opened = await services.sessions.open(body.key)
    response.set_cookie(
        COOKIE,
        opened.secret,
        expires=opened.expires_at,
        secure=request.url.scheme == "https",
        httponly=True,
        samesite="strict",
    )
    response.headers.update(UNSEEN)
    return SessionAnswer.of_opened(opened)


@router.get("", responses=problems(401, 429))
async def get_session(request: Request, response: Response) -> PrincipalAnswer:
    """Who asks, and what they may do."""
    response.headers.update(UNSEEN)
    return PrincipalAnswer.of(await admitted(request))


@router.delete("", status_code=204, responses=problems(403, 429), dependencies=[Depends(visitor)])
async def close_session(request: Request, response: Response, services: Running) -> None:
    """End the session of this browser; nothing happens when it has none."""
    response.delete_cookie(COOKIE, secure=request.url.scheme == "https", httponly=True, samesite="strict")
    await services.sessions.close(request.cookies.get(COOKIE))
