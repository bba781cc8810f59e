"""Targets to print: sheets, and single targets as pictures."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query, Response

from app.api.dependencies import Running
from app.api.problems import problems
from app.api.schemas.sites import FamilyName
from app.api.security import Reading
from app.api.sheets_query import UMm, WantedSheets
from app.services.sheets import single
from app.targets.digits import CODE_COUNT

router = APIRouter(tags=["targets"])

PDF, SVG, PNG = "application/pdf", "image/svg+xml", "image/png"
NAMED = 'inline; filename="{}"'

Code = Annotated[int, Path(ge=1, lt=CODE_COUNT)]
Family = Annotated[FamilyName, Query()]
Margin = Annotated[int, Query(ge=0, le=13, description="White paper around the plate, in u.")]
PxPerU = Annotated[int, Query(ge=1, le=200, description="Pixels per u; 100 prints u = 14 mm at 181 dpi.")]


@router.get(
    "/targets/sheets.pdf",
    response_class=Response,
    responses={200: {"content": {PDF: {}}}, **problems(404, 422, 503, 504)},
)
async def get_sheets(wish: WantedSheets, services: Running) -> Response:
    """Targets to print at 100 %: vectors, exact in millimetres; each page was read back before it left."""
    pdf = await services.printer.write(wish)
    return Response(pdf, media_type=PDF, headers={"Content-Disposition": NAMED.format("scattermark-targets.pdf")})


@router.get(
    "/targets/{code}.svg", response_class=Response, responses={200: {"content": {SVG: {}}}, **problems(404, 422)}
)
def get_target_svg(
    code: Code, _principal: Reading, family: Family = "golay", u_mm: UMm = single.DEFAULT_U_MM, margin_u: Margin = 1
) -> Response:
    """One target as SVG, in millimetres."""
    return _picture(single.svg_of_target(family, code, u_mm, margin_u), SVG, f"target-{code}.svg")


@router.get(
    "/targets/{code}.png", response_class=Response, responses={200: {"content": {PNG: {}}}, **problems(404, 422)}
)
def get_target_png(
    code: Code, _principal: Reading, family: Family = "golay", px_per_u: PxPerU = 20, margin_u: Margin = 1
) -> Response:
    """One target as PNG."""
    return _picture(single.png_of_target(family, code, px_per_u, margin_u), PNG, f"target-{code}.png")


def _picture(content: bytes, media_type: str, name: str) -> Response:
    return Response(content, media_type=media_type, headers={"Content-Disposition": NAMED.format(name)})
