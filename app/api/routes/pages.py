"""Pages for people, and their assets: files of the package, the same for everybody, guarded by the calls they make."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from fastapi import APIRouter, FastAPI
from starlette.responses import FileResponse, Response
from starlette.staticfiles import StaticFiles

from app.api.offline_worker import worker_text

WEB = Path(__file__).parents[2] / "web"
# Nothing from another host, nothing inline; pictures made in the page, the camera's video, and calls to this service.
CONTENT_SECURITY_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob: data:",
        "media-src 'self' blob:",
        "font-src 'self'",
        "connect-src 'self'",
        "worker-src 'self'",
        "manifest-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
# Asked for each time and answered with 304 while it stays: a new version shows at once.
HEADERS = {"Content-Security-Policy": CONTENT_SECURITY_POLICY, "Cache-Control": "no-cache"}

router = APIRouter(include_in_schema=False)


@router.get("/")
async def get_index() -> FileResponse:
    """The one document of all pages."""
    return FileResponse(WEB / "index.html", headers=HEADERS)


@router.get("/manifest.webmanifest")
async def get_manifest() -> FileResponse:
    """What a phone installs."""
    return FileResponse(WEB / "manifest.webmanifest", media_type="application/manifest+json", headers=HEADERS)


@router.get("/sw.js")
def get_worker() -> Response:
    """What keeps the pages' files on a device, so that they open without a network."""
    return Response(_worker(), media_type="text/javascript", headers={**HEADERS, "Service-Worker-Allowed": "/"})


@cache
def _worker() -> str:
    """Of the files as they are when it is first asked for: an installed package's do not change."""
    return worker_text(WEB)


def add_assets(app: FastAPI) -> None:
    """Serve scripts, styles, pictures and the libraries of others."""
    for folder in ("assets", "vendor"):
        app.mount(f"/{folder}", _Assets(directory=WEB / folder), name=folder)


class _Assets(StaticFiles):
    """Files with the pages' headers."""

    def file_response(self, *given: Any, **named: Any) -> Any:
        """The answer for a file."""
        answer = super().file_response(*given, **named)
        answer.headers.update(HEADERS)
        return answer
