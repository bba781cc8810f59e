"""Predicted accuracy of a site."""

from __future__ import annotations

from fastapi import APIRouter, Response

from app.api.coverage_query import WantedCoverage
from app.api.dependencies import Running
from app.api.problems import problems
from app.api.security import may_read
from app.services.coverage_report.prediction import CoverageFormat

router = APIRouter(tags=["maps"])

MEDIA_TYPES: dict[CoverageFormat, str] = {"json": "application/json", "svg": "image/svg+xml", "png": "image/png"}


@router.get(
    "/sites/{site_id}/coverage",
    dependencies=[may_read],
    response_class=Response,
    responses={200: {"content": {kind: {} for kind in MEDIA_TYPES.values()}}, **problems(404, 409, 422, 503, 504)},
)
async def get_coverage(task: WantedCoverage, services: Running) -> Response:
    """How well cameras will be located over the site: the radius that holds 95 % of positions, best and worst heading.

    With ``suggest`` it also says where the next targets should go.
    """
    content = await services.planner.predict(task)
    name = f"scattermark-coverage-{task.place.site_id}.{task.format}"
    headers = {"Content-Disposition": f'inline; filename="{name}"'}
    return Response(content, media_type=MEDIA_TYPES[task.format], headers=headers)
