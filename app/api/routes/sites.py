"""Sites and their control points."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends

from app.api.control_points_body import control_records
from app.api.dependencies import Paging, PathId, ReadSession, WriteSession
from app.api.problems import problems
from app.api.schemas.sites import (
    CONTROL_POINTS_BODY,
    ControlPointsAnswer,
    NewSiteBody,
    SiteAnswer,
    SiteChangeBody,
    SitesAnswer,
)
from app.api.security import Reading, may_read, needs
from app.services import control_points, sites
from app.services.control_points import Records
from app.storage.sites import SiteRepository

router = APIRouter(tags=["sites"])


@router.post("/sites", status_code=201, dependencies=[needs("survey")], responses=problems(400, 413, 422))
def create_site(body: NewSiteBody, session: WriteSession) -> SiteAnswer:
    """Make a site: a place whose targets share one frame, one code family and one size."""
    return SiteAnswer.of(sites.create_site(session, body.to_domain()))


@router.get("/sites", responses=problems(422))
def list_sites(page: Paging, session: ReadSession, principal: Reading) -> SitesAnswer:
    """All sites in the order they were made."""
    return SitesAnswer.of(SiteRepository(session).page(page, principal.site_ids))


@router.get("/sites/{site_id}", dependencies=[may_read], responses=problems(404, 422))
def get_site(site_id: PathId, session: ReadSession) -> SiteAnswer:
    """One site."""
    return SiteAnswer.of(SiteRepository(session).get(site_id))


@router.patch("/sites/{site_id}", dependencies=[needs("survey")], responses=problems(400, 404, 413, 422))
def change_site(site_id: PathId, body: SiteChangeBody, session: WriteSession) -> SiteAnswer:
    """Rename a site, tie it to the Earth or untie it (``geo_anchor: null``), say which snapshots' pictures are kept."""
    return SiteAnswer.of(sites.change_site(session, site_id, body.to_domain()))


@router.delete("/sites/{site_id}", status_code=204, dependencies=[needs("survey")], responses=problems(404, 409, 422))
def delete_site(site_id: PathId, session: WriteSession) -> None:
    """Remove a site with its surveys, maps and trajectories."""
    sites.delete_site(session, site_id)


@router.put(
    "/sites/{site_id}/control-points",
    dependencies=[needs("survey")],
    responses=problems(404, 413, 415, 422),
    openapi_extra={"requestBody": CONTROL_POINTS_BODY},
)
def put_control_points(
    site_id: PathId, records: Annotated[Records, Depends(control_records)], session: WriteSession
) -> ControlPointsAnswer:
    """Replace a site's control and check points; nothing changes when one row is wrong."""
    return ControlPointsAnswer.of(site_id, control_points.put_control_points(session, site_id, records))


@router.get("/sites/{site_id}/control-points", dependencies=[needs("survey", "analyse")], responses=problems(404, 422))
def get_control_points(site_id: PathId, session: ReadSession) -> ControlPointsAnswer:
    """The site's control and check points in the order they were given."""
    return ControlPointsAnswer.of(site_id, SiteRepository(session).control_points(site_id))
