"""Sites: made, shown, renamed, anchored, removed."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import Conflict
from app.storage.jobs import JobRepository
from app.storage.records import GeoAnchor, Keep, KeepingPolicy, Site
from app.storage.sites import SiteRepository
from app.targets.family import family_by_name


@dataclass(frozen=True)
class SiteChange:
    """What of a site shall change; a field that is not named stays."""

    name: str | None = None
    set_anchor: bool = False
    geo_anchor: GeoAnchor | None = None
    keep: Keep | None = None
    set_retention: bool = False
    retention_s: float | None = None

    def keeping(self, present: KeepingPolicy) -> KeepingPolicy:
        """What is kept of snapshots' pictures after the change.

        Raises
        ------
        InvalidInput
        """
        keep = present.keep if self.keep is None else self.keep
        return KeepingPolicy(keep, self.retention_s if self.set_retention else present.retention_s)


@dataclass(frozen=True)
class NewSite:
    """A site that is asked for."""

    name: str
    code_family: str
    plate_u_m: float
    geo_anchor: GeoAnchor | None = None
    keeping: KeepingPolicy = KeepingPolicy()


def create_site(session: Session, new: NewSite) -> Site:
    """A new site.

    Raises
    ------
    InvalidInput
        For a code family that does not exist.
    """
    family = family_by_name(new.code_family)
    sites = SiteRepository(session)
    site_id = sites.add(new.name, family.name, new.plate_u_m, new.geo_anchor).site_id
    sites.keep(site_id, new.keeping)
    session.flush()
    return sites.get(site_id)


def change_site(session: Session, site_id: str, change: SiteChange) -> Site:
    """Rename a site, move its anchor, or say what is kept of its snapshots' pictures.

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
    if change.keep is not None or change.set_retention:
        sites.lock(site_id)
        sites.keep(site_id, change.keeping(sites.get(site_id).keeping))
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
