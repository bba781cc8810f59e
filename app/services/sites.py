"""Sites: made, shown, renamed, anchored, removed."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import Conflict
from app.storage.jobs import JobRepository
from app.storage.records import GeoAnchor, Site
from app.storage.sites import SiteRepository
from app.targets.family import family_by_name


@dataclass(frozen=True)
class SiteChange:
    """What of a site shall change; a field that is not named stays."""

    name: str | None = None
    set_anchor: bool = False
    geo_anchor: GeoAnchor | None = None


def create_site(session: Session, name: str, code_family: str, plate_u_m: float, geo_anchor: GeoAnchor | None) -> Site:
    """A new site.

    Raises
    ------
    InvalidInput
        For a code family that does not exist.
    """
    family = family_by_name(code_family)
    return SiteRepository(session).add(name, family.name, plate_u_m, geo_anchor)


def change_site(session: Session, site_id: str, change: SiteChange) -> Site:
    """Rename a site or move its anchor.

    Code family and plate size stand: every map and detection of the site was made with them.

    Raises
    ------
    NotFound
    """
    sites = SiteRepository(session)
    if change.name is not None:
        sites.rename(site_id, change.name)
    if change.set_anchor:
        sites.anchor(site_id, change.geo_anchor)
    session.flush()
    return sites.get(site_id)


def delete_site(session: Session, site_id: str) -> None:
    """Remove a site with its surveys, maps and trajectories.

    Raises
    ------
    NotFound
    Conflict
        When a build of the site is under way.
    """
    sites = SiteRepository(session)
    sites.lock(site_id)  # first: a build that is being asked for at this moment is then seen
    jobs = JobRepository(session).open_jobs(site_id)
    if jobs:
        raise Conflict(
            f"a build of the site is under way; POST /jobs/{jobs[0].job_id}/cancel first", job_id=jobs[0].job_id
        )
    sites.delete(site_id)
