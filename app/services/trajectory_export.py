"""Trajectories as files, written while they are read, so that a million poses never stand in memory."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Literal

from app.errors import Conflict
from app.services.geodesy import geodetic
from app.storage.database import Database
from app.storage.records import Site
from app.storage.sites import SiteRepository
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import Place, TimeRange
from app.storage.trajectory_queries import TrajectoryQueries
from app.trajectories.formats import csv_text, geojson_text, tum_text
from app.trajectories.trajectory import Trajectory

TextFormat = Literal["csv", "tum", "geojson"]

POSES_AT_A_TIME = 2000  # a read of some tens of milliseconds, some hundred kilobytes of text


def trajectory_text(database: Database, trajectory_id: str, wanted: TextFormat, times: TimeRange) -> Iterator[str]:
    """The poses of a time range as the text of a file, piece by piece; failures are no poses and stay out.

    Each piece is read by a session of its own: a slow reader holds nothing up, and a pose that comes while the file
    is written is in it when its time has not been passed.

    Raises
    ------
    NotFound
        Before the first piece.
    Conflict
        For geojson when the site is not tied to the Earth; before the first piece.
    """
    with database.reading() as session:
        trajectory = TrajectoryRepository(session).get(trajectory_id)
        site = SiteRepository(session).get(trajectory.site_id)
    parts = _parts(database, trajectory_id, times)
    if wanted == "csv":
        return csv_text(parts)
    if wanted == "tum":
        return tum_text(parts)
    return _geojson(parts, trajectory_id, site)


def _geojson(parts: Iterator[Trajectory], trajectory_id: str, site: Site) -> Iterator[str]:
    anchor = site.geo_anchor
    if anchor is None:
        raise Conflict(
            "the site has no geo-anchor, so its poses have no latitude; PATCH the site with geo_anchor "
            "{latitude_deg, longitude_deg, height_m, azimuth_deg} first, or ask for json, csv or tum",
            site_id=site.site_id,
        )
    members = {"site_id": site.site_id, "trajectory_id": trajectory_id}
    return geojson_text(parts, partial(geodetic, anchor=anchor), members)


def _parts(database: Database, trajectory_id: str, times: TimeRange) -> Iterator[Trajectory]:
    after: Place | None = None
    while True:
        with database.reading() as session:
            poses, after = TrajectoryQueries(session).poses(trajectory_id, times, after, POSES_AT_A_TIME)
        if len(poses):
            yield poses
        if after is None:
            return
