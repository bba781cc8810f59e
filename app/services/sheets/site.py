"""Sheets for a site: its family, its module, its name, a link to it, and no code that hangs there already."""

from __future__ import annotations

import math
from dataclasses import replace

from sqlalchemy.orm import Session

from app.errors import InvalidInput
from app.services.sheets.wish import SheetsWish
from app.storage.records import Site
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository

MM_PER_M = 1000.0


def wish_for_site(session: Session, site_id: str, wish: SheetsWish, address: str) -> SheetsWish:
    """The wish with what the site decides.

    Parameters
    ----------
    session : Session
    site_id : str
    wish : SheetsWish
        What the caller said; family and module are the site's.
    address : str
        Of the service, without a slash at its end: where QR codes lead.

    Raises
    ------
    NotFound
    InvalidInput
        When the wish names another module than the site's plates have.
    """
    sites = SiteRepository(session)
    site = sites.get(site_id)
    u_mm = site.plate_u_m * MM_PER_M
    if wish.u_mm is not None and not math.isclose(wish.u_mm, u_mm):
        raise InvalidInput(
            f"the plates of {site.name} have u = {u_mm:g} mm, not {wish.u_mm:g}; leave u_mm out, or make another site",
            field="u_mm",
            u_mm=u_mm,
        )
    hanging = _codes_on_the_map(session, site)
    controlled = {point.code for point in sites.control_points(site_id)}
    return replace(
        wish,
        family=site.code_family,
        u_mm=u_mm,
        title=wish.title or site.name,
        link=f"{address}/#site_id={site_id}&code={{code}}",
        taken=tuple(sorted(hanging | controlled)),
    )


def _codes_on_the_map(session: Session, site: Site) -> set[int]:
    if site.active_version is None:
        return set()
    targets = TargetMapRepository(session).load(site.site_id, site.active_version).targets
    return {target.code for target in targets}
