"""Sites and their control points in the database."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from dataclasses import asdict
from typing import cast

import numpy as np
from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.geometry.control import ControlPoint, Role
from app.storage.belonging import within
from app.storage.ids import new_id
from app.storage.models import ControlPointRow, SiteRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.records import GeoAnchor, Keep, KeepingPolicy, Site


class SiteRepository:
    """Sites of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, name: str, code_family: str, plate_u_m: float, geo_anchor: GeoAnchor | None) -> Site:
        """A new site without a target map."""
        row = SiteRow(
            id=new_id(),
            name=name,
            code_family=code_family,
            plate_u_m=plate_u_m,
            geo_anchor=None if geo_anchor is None else asdict(geo_anchor),
            active_version=None,
            last_version=0,
            keep_snapshots=Keep.NONE.value,
            snapshot_retention_s=None,
            created_s=time.time(),
        )
        self._session.add(row)
        self._session.flush()
        return _site(row)

    def get(self, site_id: str) -> Site:
        """One site.

        Raises
        ------
        NotFound
        """
        return _site(find_site_row(self._session, site_id))

    def page(self, request: PageRequest, site_ids: Collection[str] | None = None) -> Page[Site]:
        """Sites in the order they were made; of these alone if given."""
        query = select(SiteRow).where(within(SiteRow.id, site_ids)).order_by(SiteRow.id).limit(request.limit + 1)
        if request.after is not None:
            query = query.where(SiteRow.id > request.after)
        return page_of([(row.id, _site(row)) for row in self._session.scalars(query)], request.limit)

    def rename(self, site_id: str, name: str) -> None:
        """Give a site another name."""
        find_site_row(self._session, site_id, lock=True).name = name

    def anchor(self, site_id: str, geo_anchor: GeoAnchor | None) -> None:
        """Tie a site to the Earth, or untie it."""
        row = find_site_row(self._session, site_id, lock=True)
        row.geo_anchor = None if geo_anchor is None else asdict(geo_anchor)

    def keep(self, site_id: str, keeping: KeepingPolicy) -> None:
        """Say what is kept of the pictures of snapshots from now on, and for how long what is kept stays."""
        row = find_site_row(self._session, site_id, lock=True)
        row.keep_snapshots, row.snapshot_retention_s = keeping.keep.value, keeping.retention_s

    def lock(self, site_id: str) -> None:
        """Let nobody else change a site, or add anything to it, until the transaction ends.

        Raises
        ------
        NotFound
        """
        find_site_row(self._session, site_id, lock=True)

    def delete(self, site_id: str) -> None:
        """Remove a site with all that belongs to it; its photographs' files stay until orphans are purged."""
        self._session.delete(find_site_row(self._session, site_id, lock=True))
        self._session.flush()

    def replace_control_points(self, site_id: str, points: Sequence[ControlPoint]) -> None:
        """Put these control and check points in the place of the site's present ones."""
        find_site_row(self._session, site_id, lock=True)
        self._session.execute(delete(ControlPointRow).where(ControlPointRow.site_id == site_id))
        self._session.add_all(_control_row(site_id, ordinal, point) for ordinal, point in enumerate(points))
        self._session.flush()

    def control_points(self, site_id: str) -> tuple[ControlPoint, ...]:
        """The site's control and check points in the order they were given."""
        find_site_row(self._session, site_id)
        query = select(ControlPointRow).where(ControlPointRow.site_id == site_id).order_by(ControlPointRow.ordinal)
        return tuple(_control_point(row) for row in self._session.scalars(query))


def find_site_row(session: Session, site_id: str, *, lock: bool = False) -> SiteRow:
    """The row of a site; ``lock`` keeps other writers from it until the transaction ends.

    Raises
    ------
    NotFound
    """
    row = session.get(SiteRow, site_id, with_for_update=lock)
    if row is None:
        raise no_site(site_id)
    return row


def no_site(site_id: str) -> NotFound:
    """The error for a site that does not exist."""
    return NotFound(f"there is no site {site_id}; GET /sites lists them", site_id=site_id)


def _site(row: SiteRow) -> Site:
    return Site(
        site_id=row.id,
        name=row.name,
        code_family=row.code_family,
        plate_u_m=row.plate_u_m,
        geo_anchor=None if row.geo_anchor is None else GeoAnchor(**row.geo_anchor),
        active_version=row.active_version,
        created_s=row.created_s,
        keeping=KeepingPolicy(Keep(row.keep_snapshots), row.snapshot_retention_s),
    )


def _control_row(site_id: str, ordinal: int, point: ControlPoint) -> ControlPointRow:
    x_m, y_m, z_m = (float(value) for value in point.position_m)
    return ControlPointRow(
        id=new_id(),
        site_id=site_id,
        ordinal=ordinal,
        name=point.name,
        code=point.code,
        dot=point.dot,
        x_m=x_m,
        y_m=y_m,
        z_m=z_m,
        sigma_m=point.sigma_m,
        role=point.role,
    )


def _control_point(row: ControlPointRow) -> ControlPoint:
    position_m = np.array([row.x_m, row.y_m, row.z_m])
    return ControlPoint(row.name, row.code, row.dot, position_m, row.sigma_m, cast(Role, row.role))
