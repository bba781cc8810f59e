"""Published maps as their users see them: the targets in four formats, the report, the versions."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from app.errors import Conflict
from app.geometry.camera import Camera
from app.geometry.map_file import MapCamera, MapFile, map_to_json, target_to_json
from app.geometry.target_map import TargetMap
from app.services.geodesy import geodetic
from app.storage.cameras import CameraRepository
from app.storage.paging import Page, PageRequest
from app.storage.records import MapVersion, PhotoResult, Site
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from app.targets.layout import BASE_CELLS, CELLS_PER_SIDE, DOT_COUNT

METRES_DIGITS = 6  # micrometres
RED, GREY = "200 28 36", "238 238 232"  # print colours of targets.md: base dots, and one for all others
DOT_COLUMNS = [
    f"r{cell // CELLS_PER_SIDE}c{cell % CELLS_PER_SIDE}_{axis}_m" for cell in range(DOT_COUNT) for axis in "xyz"
]
POSE_COLUMNS = ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "sigma_x_m", "sigma_y_m", "sigma_z_m"]
CSV_COLUMNS = ["code", *POSE_COLUMNS, "rays", "rms_px", *DOT_COLUMNS]


@dataclass(frozen=True)
class PublishedMap:
    """A version of a site's target map and the cameras of its survey."""

    site: Site
    version: int
    target_map: TargetMap
    cameras: tuple[MapCamera, ...]


def published_map(session: Session, site_id: str, version: int | None) -> PublishedMap:
    """A version of a site's map, the active one when none is named.

    Raises
    ------
    NotFound
        When the site or the version does not exist.
    Conflict
        When none is named and the site has no map.
    """
    maps = TargetMapRepository(session)
    found = maps.version(site_id, version).version
    stored = CameraRepository(session).of_map(site_id, found)
    cameras = tuple(MapCamera(camera.identity, camera.calibrated) for camera in stored)
    return PublishedMap(SiteRepository(session).get(site_id), found, maps.load(site_id, found), cameras)


@dataclass(frozen=True)
class MappedPhoto:
    """What became of a photograph of a map, and its camera as the map's survey calibrated it; None without a pose."""

    result: PhotoResult
    camera: Camera | None


def mapped_photos(session: Session, site_id: str, version: int, request: PageRequest) -> Page[MappedPhoto]:
    """The photographs of a version, by name.

    Raises
    ------
    NotFound
        When the site or the version does not exist.
    """
    page = TargetMapRepository(session).photo_page(site_id, version, request)
    stored = CameraRepository(session).of_map(site_id, version)
    cameras = {camera.identity.key: camera.calibrated.camera for camera in stored}
    items = tuple(MappedPhoto(result, cameras.get(result.camera_key or "")) for result in page.items)
    return Page(items, page.next_cursor)


def activate_map(session: Session, site_id: str, version: int) -> MapVersion:
    """Make a version the one that snapshots are located in.

    Raises
    ------
    NotFound
    """
    maps = TargetMapRepository(session)
    maps.activate(site_id, version)
    session.flush()
    return maps.version(site_id, version)


def adjustment_report(session: Session, site_id: str, version: int | None) -> dict[str, Any]:
    """The report of a version's adjustment, with the photographs that never reached it.

    Raises
    ------
    NotFound, Conflict
        As ``published_map``.
    """
    maps = TargetMapRepository(session)
    found = maps.version(site_id, version)
    unoriented = [
        {"name": photo.name, "reason": photo.reason}
        for photo in maps.photos(site_id, found.version)
        if photo.site_from_cam is None
    ]
    report = maps.report(site_id, found.version)
    return {"site_id": site_id, "map_version": found.version, **report, "photographs_left_out": unoriented}


def json_of_map(published: PublishedMap) -> dict[str, Any]:
    """The map as a file's content: the published fields, and all that an honest pose needs."""
    members = {"site_id": published.site.site_id, "map_version": published.version}
    return {**members, **map_to_json(MapFile(published.target_map, published.cameras))}


def csv_of_map(published: PublishedMap) -> str:
    """One line per target."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for target in published.target_map.targets:
        pose = target.site_from_target
        sigma_m = target_to_json(target, published.target_map.datum)["sigma_m"]
        numbers = [*pose.position_m, *pose.orientation_xyzw, *sigma_m]
        dots_m = [round(float(value), METRES_DIGITS) for value in target.dots_m.ravel()]
        rounded = [round(float(value), METRES_DIGITS) for value in numbers]
        writer.writerow([target.code, *rounded, target.rays, round(target.rms_px, METRES_DIGITS), *dots_m])
    return text.getvalue()


def ply_of_map(published: PublishedMap) -> str:
    """One coloured vertex per dot (ASCII PLY 1.0), with its target's code and its cell."""
    lines = [
        f"{x:.6f} {y:.6f} {z:.6f} {RED if cell in BASE_CELLS else GREY} {target.code} {cell}"
        for target in published.target_map.targets
        for cell, (x, y, z) in enumerate(target.dots_m)
    ]
    header = [
        "ply",
        "format ascii 1.0",
        f"comment site {published.site.site_id} map version {published.version}, metres",
        f"element vertex {len(lines)}",
        *(f"property double {axis}" for axis in "xyz"),
        *(f"property uchar {colour}" for colour in ("red", "green", "blue")),
        "property int code",
        "property uchar cell",
        "end_header",
    ]
    return "\n".join([*header, *lines]) + "\n"


def geojson_of_map(published: PublishedMap) -> str:
    """One point per target (RFC 7946).

    Raises
    ------
    Conflict
        When the site is not tied to the Earth.
    """
    anchor = published.site.geo_anchor
    if anchor is None:
        raise Conflict(
            "the site has no geo-anchor, so its targets have no latitude; PATCH the site with geo_anchor "
            "{latitude_deg, longitude_deg, height_m, azimuth_deg} first, or ask for json, csv or ply",
            site_id=published.site.site_id,
        )
    features = []
    for target in published.target_map.targets:
        record = target_to_json(target, published.target_map.datum)
        properties = {name: record[name] for name in ("code", "position_m", "sigma_m", "rays", "rms_px")}
        coordinates = geodetic(target.site_from_target.position_m, anchor).tolist()
        point = {"type": "Point", "coordinates": coordinates}
        features.append({"type": "Feature", "id": target.code, "geometry": point, "properties": properties})
    members = {"site_id": published.site.site_id, "map_version": published.version}
    return json.dumps({"type": "FeatureCollection", **members, "features": features})
