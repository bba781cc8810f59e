"""Trajectories as files, written while they are read, so that a million poses never stand in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Literal, get_args

from app.errors import Conflict
from app.services.geodesy import enu_from_site, geodetic
from app.storage.database import Database
from app.storage.pose_reading import pose_parts
from app.storage.records import GeoAnchor, Site
from app.storage.sites import SiteRepository
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import StoredTrajectory, TimeRange
from app.trajectories.competition_formats import posi_text, position_log_text
from app.trajectories.formats import csv_text, geojson_text
from app.trajectories.geopose import geopose_text
from app.trajectories.robotics_formats import euroc_text, kitti_text, kitti_times_text, tum_text
from app.trajectories.trajectory import Trajectory

TextFormat = Literal["csv", "tum", "kitti", "kitti-times", "euroc", "evaal", "posi", "geojson", "geopose"]
Write = Callable[[Iterable[Trajectory]], Iterator[str]]

PLAIN: dict[TextFormat, Write] = {
    "csv": csv_text,
    "tum": tum_text,
    "kitti": kitti_text,
    "kitti-times": kitti_times_text,
    "euroc": euroc_text,
    "evaal": position_log_text,
}
NEEDS_ORIENTATIONS: tuple[TextFormat, ...] = ("tum", "kitti", "euroc", "geopose")


def trajectory_text(database: Database, trajectory_id: str, wanted: TextFormat, times: TimeRange) -> Iterator[str]:
    """The poses of a time range as the text of a file, piece by piece; failures are no poses and stay out.

    Each piece is read by a session of its own: a slow reader holds nothing up, and a pose that comes while the file
    is written is in it when its time has not been passed.

    Raises
    ------
    NotFound
        Before the first piece.
    Conflict
        For posi, geojson and geopose when the site is not tied to the Earth, and for a format with orientations when
        the trajectory has positions only; before the first piece.
    """
    with database.reading() as session:
        trajectory = TrajectoryRepository(session).get(trajectory_id)
        site = SiteRepository(session).get(trajectory.site_id)
    write = writer_of(wanted, trajectory, site)
    return write(pose_parts(database, trajectory, times))


def writer_of(wanted: TextFormat, trajectory: StoredTrajectory, site: Site) -> Write:
    """What writes the trajectory in a format.

    Raises
    ------
    Conflict
        When it cannot be written so.
    """
    if wanted in NEEDS_ORIENTATIONS and not trajectory.oriented:
        others = [name for name in get_args(TextFormat) if name not in NEEDS_ORIENTATIONS]
        raise Conflict(
            f"trajectory {trajectory.trajectory_id} was imported with positions only, and {wanted} needs orientations; "
            f"ask for json, {', '.join(others)}",
            trajectory_id=trajectory.trajectory_id,
        )
    if wanted in PLAIN:
        return PLAIN[wanted]
    anchor = _anchor_of(site)
    if wanted == "posi":
        return partial(posi_text, geodetic=partial(geodetic, anchor=anchor))
    if wanted == "geopose":
        return partial(geopose_text, geodetic=partial(geodetic, anchor=anchor), enu_from_site=enu_from_site(anchor))
    members = {"site_id": site.site_id, "trajectory_id": trajectory.trajectory_id}
    return partial(geojson_text, geodetic=partial(geodetic, anchor=anchor), members=members)


def _anchor_of(site: Site) -> GeoAnchor:
    if site.geo_anchor is None:
        raise Conflict(
            "the site has no geo-anchor, so its poses have no latitude; PATCH the site with geo_anchor "
            "{latitude_deg, longitude_deg, height_m, azimuth_deg} first, or ask for json, csv or tum",
            site_id=site.site_id,
        )
    return site.geo_anchor
