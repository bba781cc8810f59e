"""Target maps, their versions, their reports."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Query, Response

from app.api.dependencies import Paging, PathId, PathVersion, ReadSession, Running, Version, WriteSession
from app.api.problems import problems
from app.api.report_answer import MEDIA_TYPES, preferred_format, report_response
from app.api.schemas.maps import MapAnswer, MapPhotosAnswer, MapsAnswer, TargetsAnswer
from app.api.security import may_read, needs
from app.services import maps
from app.services.report_work import ReportFormat, ReportTask
from app.storage.target_maps import TargetMapRepository

router = APIRouter(tags=["maps"])

WRITERS = {
    "csv": (maps.csv_of_map, "text/csv"),
    "ply": (maps.ply_of_map, "application/ply"),
    "geojson": (maps.geojson_of_map, "application/geo+json"),
}
TEXT_FORMATS = {media_type: {"schema": {"type": "string"}} for _, media_type in WRITERS.values()}


@router.get(
    "/sites/{site_id}/targets",
    dependencies=[may_read],
    response_model=TargetsAnswer,
    responses={200: {"content": TEXT_FORMATS}, **problems(404, 409, 422)},
)
def get_targets(
    site_id: PathId,
    session: ReadSession,
    format: Annotated[Literal["json", "csv", "geojson", "ply"], Query()] = "json",  # noqa: A002 - the query's name
    version: Version | None = None,
) -> Any:
    """A version of a site's target map."""
    published = maps.published_map(session, site_id, version)
    if format == "json":
        return maps.json_of_map(published)
    write, media_type = WRITERS[format]
    return Response(write(published), media_type=media_type)


@router.get(
    "/sites/{site_id}/report",
    dependencies=[needs("survey", "analyse")],
    response_class=Response,
    responses={200: {"content": {kind: {} for kind in MEDIA_TYPES.values()}}, **problems(404, 409, 422, 503, 504)},
)
async def get_report(
    site_id: PathId,
    services: Running,
    format: Annotated[ReportFormat | None, Query()] = None,  # noqa: A002 - the query's name
    version: Version | None = None,
    accept: Annotated[str, Header(include_in_schema=False)] = "",
) -> Response:
    """The adjustment report of a version: what a surveyor signs; without ``format`` browsers get html, others json."""
    wanted = format or preferred_format(accept)
    report = await services.reports.write(ReportTask(site_id, version, wanted))
    return report_response(site_id, report, wanted)


@router.get("/sites/{site_id}/maps", dependencies=[may_read], responses=problems(404, 422))
def list_maps(site_id: PathId, page: Paging, session: ReadSession) -> MapsAnswer:
    """The versions of a site's target map."""
    return MapsAnswer.of(TargetMapRepository(session).versions(site_id, page))


@router.get(
    "/sites/{site_id}/maps/{version}/photos",
    dependencies=[needs("survey", "analyse")],
    responses=problems(404, 422),
)
def list_map_photos(site_id: PathId, version: PathVersion, page: Paging, session: ReadSession) -> MapPhotosAnswer:
    """Where the photographs of a version were taken and which targets they show, by name."""
    return MapPhotosAnswer.of(maps.mapped_photos(session, site_id, version, page))


@router.post("/sites/{site_id}/maps/{version}/activate", dependencies=[needs("survey")], responses=problems(404, 422))
def activate_map(site_id: PathId, version: PathVersion, session: WriteSession) -> MapAnswer:
    """Locate snapshots in this version from now on."""
    return MapAnswer.of(maps.activate_map(session, site_id, version))
