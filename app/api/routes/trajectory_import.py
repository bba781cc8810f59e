"""Trajectories of other systems, as files."""

from __future__ import annotations

from fastapi import APIRouter, Request

from app.api.dependencies import Running
from app.api.problems import problems
from app.api.schemas.trajectory_import import ImportAnswer
from app.api.security import Analysing
from app.api.trajectory_file_body import import_openapi, sent_file

router = APIRouter(tags=["trajectories"])


@router.post(
    "/trajectories/import",
    status_code=201,
    responses=problems(400, 404, 409, 413, 422, 503, 504, 507),
    openapi_extra=import_openapi(),
)
async def import_trajectory(request: Request, services: Running, principal: Analysing) -> ImportAnswer:
    """Take in a trajectory in csv, tum, euroc, kitti, evaal or geojson; as a whole, or nothing of it."""
    async with sent_file(request) as sent:
        principal.site(sent.parameters.site_id)
        return ImportAnswer.of(await services.importer.take(sent.parameters.to_domain(), sent.arriving))
