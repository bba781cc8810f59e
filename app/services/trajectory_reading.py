"""A file of any format -> a trajectory in the site frame; those that stand on the Earth need the site's geo-anchor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from app.errors import Conflict, InvalidInput
from app.services.capture_time import LATEST_S
from app.services.geodesy import enu_from_site, site_of_geodetic
from app.storage.records import GeoAnchor
from app.trajectories.reading.any_file import format_of, read_trajectory
from app.trajectories.reading.evaal import POSI, posi_table
from app.trajectories.reading.geojson import read_geojson
from app.trajectories.reading.geopose import read_geopose
from app.trajectories.reading.kitti import read_kitti
from app.trajectories.reading.poses import Reading, times_s_of, whole_floors
from app.trajectories.reading.table import UnreadableTrajectory
from app.trajectories.reading.time_units import TimeUnit, UnitName
from app.trajectories.trajectory import Array, Trajectory

ImportFormat = Literal["csv", "tum", "euroc", "kitti", "evaal", "geojson", "geopose"]
SEEN = 4096  # bytes of a file that tell its kind


@dataclass(frozen=True)
class TrajectoryFile:
    """A file as it came.

    Attributes
    ----------
    data : bytes
    times : bytes or None
        The stamps' own file, of KITTI.
    format : str or None
        Seen in the file when None.
    time_unit : {"s", "ms", "us", "ns"} or None
        Seen in the stamps when None.
    """

    data: bytes
    times: bytes | None = None
    format: ImportFormat | None = None
    time_unit: UnitName | None = None


@dataclass(frozen=True)
class ReadFile:
    """What a file held, and of which format it was."""

    format: ImportFormat
    reading: Reading


def read_file(file: TrajectoryFile, anchor: GeoAnchor | None) -> ReadFile:
    """The trajectory of a file, in the site frame.

    Raises
    ------
    UnreadableTrajectory
        Naming line and column.
    InvalidInput
        For KITTI without stamps, or stamps without KITTI.
    Conflict
        For positions on the Earth when the site has no geo-anchor.
    """
    file_format = file.format or _format_of(file)
    if file.times is not None and file_format != "kitti":
        raise InvalidInput(f"a file of stamps belongs to kitti, and this is {file_format}; leave times out")
    read = ReadFile(file_format, _reading(file, file_format, anchor))
    trajectory, unit = read.reading.trajectory, read.reading.time_unit
    _check_times(trajectory.times_s, unit)
    if trajectory.arrived_s is not None:
        _check_times(trajectory.arrived_s, unit)
    return read


def _format_of(file: TrajectoryFile) -> ImportFormat:
    if file.times is not None:
        return "kitti"
    if _holds_posi(file.data):
        return "evaal"
    begin = file.data[:SEEN].lstrip(b"\xef\xbb\xbf \t\r\n")
    if begin.startswith(b"["):
        return "geopose"
    if begin.startswith(b"{"):
        return "geopose" if b'"quaternion"' in begin and b'"features"' not in begin else "geojson"
    return format_of(file.data)


def _reading(file: TrajectoryFile, file_format: ImportFormat, anchor: GeoAnchor | None) -> Reading:
    if file_format == "kitti":
        if file.times is None:
            raise InvalidInput(
                "kitti keeps its stamps in a file of their own; send it beside the poses as `times`", field="times"
            )
        return read_kitti(file.data, file.times, file.time_unit)
    if file_format == "geojson":
        return _of_geojson(file.data, anchor)
    if file_format == "geopose":
        return _of_geopose(file.data, anchor)
    if file_format == "evaal" and _holds_posi(file.data):
        return _of_posi(file, anchor)
    return read_trajectory(file.data, file_format, file.time_unit)


def _holds_posi(data: bytes) -> bool:
    """Whether the file is an IPIN log with true positions."""
    mark = POSI.encode()
    return data.startswith(mark) or b"\n" + mark in data


def _of_geojson(data: bytes, anchor: GeoAnchor | None) -> Reading:
    poses = read_geojson(data)
    trajectory = Trajectory(
        poses.times_s,
        _site_m(poses.places_deg_m, anchor),
        poses.orientations_xyzw,
        poses.covariances,
        poses.floors,
        poses.arrived_s,
    )
    return Reading(trajectory, TimeUnit("s", detected=True))


def _of_geopose(data: bytes, anchor: GeoAnchor | None) -> Reading:
    poses = read_geopose(data)
    positions_m = _site_m(poses.places_deg_m, anchor)
    assert anchor is not None and poses.orientations_xyzw is not None
    site_from_enu = Rotation.from_matrix(enu_from_site(anchor).T)
    orientations_xyzw = (site_from_enu * Rotation.from_quat(poses.orientations_xyzw)).as_quat(canonical=True)
    return Reading(Trajectory(poses.times_s, positions_m, orientations_xyzw), TimeUnit("ms", detected=True))


def _of_posi(file: TrajectoryFile, anchor: GeoAnchor | None) -> Reading:
    table = posi_table(file.data)
    times_s, unit = times_s_of(table, "timestamp", "s", file.time_unit)
    places_deg_m = np.column_stack([table.block(("longitude", "latitude")), np.full(len(times_s), np.nan)])
    return Reading(Trajectory(times_s, _site_m(places_deg_m, anchor), floors=whole_floors(table)), unit)


def _site_m(places_deg_m: Array, anchor: GeoAnchor | None) -> Array:
    """Positions in the site frame, shape (N, 3); at z = 0 where no height is told."""
    if anchor is None:
        raise Conflict(
            "the file tells latitudes and the site has no geo-anchor; PATCH the site with geo_anchor {latitude_deg, "
            "longitude_deg, height_m, azimuth_deg} first, or send positions in metres of the site"
        )
    heights_m = places_deg_m[:, 2]
    known = np.where(np.isnan(heights_m), anchor.height_m, heights_m)
    return site_of_geodetic(np.column_stack([places_deg_m[:, :2], known]), anchor)


def _check_times(times_s: Array, unit: TimeUnit) -> None:
    """See that each stamp is a time that an answer can write."""
    least_s, greatest_s = float(times_s.min()), float(times_s.max())
    if least_s >= 0.0 and greatest_s <= LATEST_S:
        return
    wrong_s = least_s if least_s < 0.0 else greatest_s
    raise UnreadableTrajectory(
        f"the stamp {wrong_s:g} s lies before 1970 or after 9999 ({unit.sentence}); name the unit as time_unit, or "
        "shift the stamps",
        column="timestamp",
    )
