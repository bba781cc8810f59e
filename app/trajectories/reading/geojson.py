"""GeoJSON: one point per pose, with its time among the properties; positions on the Earth."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np

from app.trajectories.reading.poses import LENGTH_TOLERANCE
from app.trajectories.reading.table import GREATEST_NUMBER, GREATEST_ROWS, SHOWN, UnreadableTrajectory, text_of
from app.trajectories.trajectory import Array

TIMES = ("time", "time_utc", "timestamp", "time_s")
ORIENTATION, FLOOR = "orientation_xyzw", "floor"
GREATEST_FLOOR = 1000  # no house has so many


@dataclass(frozen=True)
class GeodeticPoses:
    """Poses whose positions stand on the Earth (WGS 84).

    Attributes
    ----------
    times_s : ndarray of shape (N,)
        UTC, strictly increasing.
    places_deg_m : ndarray of shape (N, 3)
        Longitude (deg), latitude (deg), height above the ellipsoid (m); NaN for a height that the file does not tell.
    orientations_xyzw : ndarray of shape (N, 4) or None
        Of the site frame.
    floors : ndarray of int, shape (N,), or None
    """

    times_s: Array
    places_deg_m: Array
    orientations_xyzw: Array | None
    floors: np.ndarray[tuple[int], np.dtype[np.int64]] | None


def read_geojson(data: bytes) -> GeodeticPoses:
    """Poses of a feature collection of points, such as this project writes.

    Each feature has its time as ``time`` (ISO 8601, or seconds since 1970) and may have ``orientation_xyzw`` and
    ``floor``; what the first has, all have. Covariances are not read.

    Raises
    ------
    UnreadableTrajectory
        Naming the feature (from 1) and its member.
    """
    features = _features(data)
    first = _properties(1, features[0])
    turned, storeyed = ORIENTATION in first, FLOOR in first
    times_s = np.array(_each(features, _time_s))
    late = np.flatnonzero(np.diff(times_s) <= 0)
    if len(late):
        raise _refuse(int(late[0]) + 2, "time", "it is not after the one before; sort the points by time")
    return GeodeticPoses(
        times_s,
        np.array(_each(features, _place)),
        np.array(_each(features, _orientation)) if turned else None,
        np.array(_each(features, _floor), dtype=np.int64) if storeyed else None,
    )


def _features(data: bytes) -> list[Any]:
    try:
        document = json.loads(text_of(data))
    except (ValueError, RecursionError) as error:
        line = getattr(error, "lineno", 1)
        raise UnreadableTrajectory(f"line {line}: this is no JSON ({error})"[:300], line=line) from error
    features = document.get("features") if isinstance(document, dict) else None
    if not isinstance(features, list) or not features:
        raise UnreadableTrajectory("the file is no FeatureCollection with one point at least; send one point per pose")
    if len(features) > GREATEST_ROWS:
        raise UnreadableTrajectory(f"the file has more than {GREATEST_ROWS} points; send it in parts")
    return features


def _each(features: list[Any], read: Callable[[int, Any], Any]) -> list[Any]:
    return [read(number, feature) for number, feature in enumerate(features, start=1)]


def _properties(number: int, feature: Any) -> dict[str, Any]:
    properties = feature.get("properties") if isinstance(feature, dict) else None
    if not isinstance(properties, dict):
        raise _refuse(number, "properties", "a pose needs properties with its time")
    return properties


def _time_s(number: int, feature: Any) -> float:
    properties = _properties(number, feature)
    name = next((name for name in TIMES if name in properties), None)
    if name is None:
        raise _refuse(number, "time", "a pose needs its time: ISO 8601, or seconds since 1970")
    told = properties[name]
    if _is_number(told):
        return float(told)
    try:
        moment = datetime.fromisoformat(told)
    except (TypeError, ValueError) as error:
        raise _refuse(number, name, f"{str(told)[:SHOWN]!r} is no time like 2026-03-01T12:00:00Z") from error
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _place(number: int, feature: Any) -> list[float]:
    geometry = feature.get("geometry")
    place = geometry.get("coordinates") if isinstance(geometry, dict) and geometry.get("type") == "Point" else None
    if not isinstance(place, list) or len(place) not in (2, 3) or not all(_is_number(value) for value in place):
        raise _refuse(number, "geometry", "a pose is a Point with longitude, latitude and, if known, height")
    if abs(place[0]) > 180 or abs(place[1]) > 90:
        raise _refuse(number, "geometry", f"{place[:2]} is no longitude and latitude in degrees")
    return [*map(float, place)] if len(place) == 3 else [float(place[0]), float(place[1]), math.nan]


def _orientation(number: int, feature: Any) -> Array:
    told = _properties(number, feature).get(ORIENTATION)
    if not isinstance(told, list) or len(told) != 4 or not all(_is_number(value) for value in told):
        raise _refuse(number, ORIENTATION, "four numbers x, y, z, w are needed, as the first point has them")
    quaternion = np.array(told, dtype=np.float64)
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1.0) > LENGTH_TOLERANCE:
        raise _refuse(number, ORIENTATION, f"the quaternion has the length {length:.4g}, and 1 is needed")
    return quaternion / length


def _floor(number: int, feature: Any) -> int:
    told: Any = _properties(number, feature).get(FLOOR)
    if not _is_number(told) or told != int(told) or abs(told) > GREATEST_FLOOR:
        raise _refuse(number, FLOOR, f"{str(told)[:SHOWN]!r} is no storey; storeys are whole numbers")
    return int(told)


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) < GREATEST_NUMBER


def _refuse(number: int, member: str, what: str) -> UnreadableTrajectory:
    return UnreadableTrajectory(f"feature {number}, {member}: {what}", feature=number, column=member)
