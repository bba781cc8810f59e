"""The interface described for people."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from app.api.docs_page import CONTENT_SECURITY_POLICY, docs_page

router = APIRouter(include_in_schema=False)


@router.get("/docs")
async def get_docs(request: Request) -> HTMLResponse:
    """All calls on one page."""
    return HTMLResponse(docs_page(request.app.openapi()), headers={"Content-Security-Policy": CONTENT_SECURITY_POLICY})
