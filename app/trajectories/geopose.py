"""Trajectories as OGC GeoPose 1.0: where a camera stands on the Earth, and its turn against east, north and up."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from app.trajectories.robotics_formats import orientations_of
from app.trajectories.trajectory import Array, Trajectory

DEGREE_DIGITS, HEIGHT_DIGITS, UNIT_DIGITS = 9, 4, 9  # 0.1 mm on the ground and in height, 1e-9 of a quaternion
MILLISECONDS = 1e3


def geopose_text(
    parts: Iterable[Trajectory], geodetic: Callable[[Array], Array], enu_from_site: Array
) -> Iterator[str]:
    """A JSON array of Basic-Quaternion poses in the order of time.

    Parameters
    ----------
    parts : iterable of Trajectory
    geodetic : callable
        Takes positions of shape (N, 3) of the site frame to longitude (deg), latitude (deg) and height (m).
    enu_from_site : ndarray of shape (3, 3)

    Notes
    -----
    OGC 21-056r11, Basic-Quaternion: ``position`` in WGS 84, ``quaternion`` the rotation from the camera's axes (x
    right, y down, z forward) to east, north and up. The standard's basic form has no time; ``validTime``, milliseconds
    since 1970, is the name and unit that its advanced form gives it.
    """
    turn = Rotation.from_matrix(enu_from_site)
    separator = "[\n"
    for part in parts:
        yield separator + ",\n".join(_poses(part, geodetic(part.positions_m), turn))
        separator = ",\n"
    yield "[]\n" if separator == "[\n" else "\n]\n"


def _poses(part: Trajectory, places: Array, turn: Rotation) -> Iterator[str]:
    quaternions = (turn * Rotation.from_quat(orientations_of(part))).as_quat(canonical=True)
    columns = zip(
        np.round(places[:, :2], DEGREE_DIGITS).tolist(),
        np.round(places[:, 2], HEIGHT_DIGITS).tolist(),
        np.round(quaternions, UNIT_DIGITS).tolist(),
        np.round(part.times_s * MILLISECONDS).astype(np.int64).tolist(),
        strict=True,
    )
    for (longitude_deg, latitude_deg), height_m, quaternion, time_ms in columns:
        position = {"lat": latitude_deg, "lon": longitude_deg, "h": height_m}
        turned = dict(zip("xyzw", quaternion, strict=True))
        yield json.dumps({"position": position, "quaternion": turned, "validTime": time_ms})
