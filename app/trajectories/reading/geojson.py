"""GeoJSON: one point per pose, with its time among the properties; positions on the Earth."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from app.trajectories.reading.covariances import check_definite
from app.trajectories.reading.json_values import (
    GeodeticPoses,
    Member,
    document_of,
    increasing,
    is_number,
    listed,
    moment_s,
    square_matrix,
    unit_quaternion,
)
from app.trajectories.reading.poses import GREATEST_FLOOR, check_arrivals
from app.trajectories.reading.table import SHOWN
from app.trajectories.trajectory import Array

TIMES = ("time", "time_utc", "timestamp", "time_s")
ORIENTATION, FLOOR, COVARIANCE, ARRIVED = "orientation_xyzw", "floor", "covariance", "arrived"
FEATURE = "feature"


def read_geojson(data: bytes) -> GeodeticPoses:
    """Poses of a feature collection of points, such as this project writes.

    Each feature has its time as ``time`` (ISO 8601, or seconds since 1970) and may have ``orientation_xyzw``,
    ``floor``, ``covariance`` (6 x 6, or 3 x 3 without an orientation) and ``arrived``; what the first has, all have.

    Raises
    ------
    UnreadableTrajectory
        Naming the feature (from 1) and its member.
    """
    document = document_of(data)
    features = listed(document.get("features") if isinstance(document, dict) else None, "FeatureCollection of points")
    first = _properties(1, features[0])
    size = 6 if ORIENTATION in first else 3
    times_s = np.array(_each(features, _time_s))
    increasing(times_s, FEATURE, "time")
    covariances = np.array(_each(features, _covariance_of(size))) if COVARIANCE in first else None
    if covariances is not None:
        check_definite(covariances, lambda row, what: Member(FEATURE, row + 1, COVARIANCE).refuse(what))
    arrived_s = np.array(_each(features, _arrived_s)) if ARRIVED in first else None
    if arrived_s is not None:
        check_arrivals(arrived_s - times_s, lambda row, what: Member(FEATURE, row + 1, ARRIVED).refuse(what))
    return GeodeticPoses(
        times_s,
        np.array(_each(features, _place)),
        np.array(_each(features, _orientation)) if ORIENTATION in first else None,
        np.array(_each(features, _floor), dtype=np.int64) if FLOOR in first else None,
        covariances,
        arrived_s,
    )


def _each(features: list[Any], read: Callable[[int, Any], Any]) -> list[Any]:
    return [read(number, feature) for number, feature in enumerate(features, start=1)]


def _properties(number: int, feature: Any) -> dict[str, Any]:
    properties = feature.get("properties") if isinstance(feature, dict) else None
    if not isinstance(properties, dict):
        raise Member(FEATURE, number, "properties").refuse("a pose needs properties with its time")
    return properties


def _time_s(number: int, feature: Any) -> float:
    properties = _properties(number, feature)
    name = next((name for name in TIMES if name in properties), None)
    if name is None:
        raise Member(FEATURE, number, "time").refuse("a pose needs its time: ISO 8601, or seconds since 1970")
    return moment_s(properties[name], Member(FEATURE, number, name))


def _place(number: int, feature: Any) -> list[float]:
    member = Member(FEATURE, number, "geometry")
    geometry = feature.get("geometry")
    place = geometry.get("coordinates") if isinstance(geometry, dict) and geometry.get("type") == "Point" else None
    if not isinstance(place, list) or len(place) not in (2, 3) or not all(is_number(value) for value in place):
        raise member.refuse("a pose is a Point with longitude, latitude and, if known, height")
    if abs(place[0]) > 180 or abs(place[1]) > 90:
        raise member.refuse(f"{place[:2]} is no longitude and latitude in degrees")
    return [*map(float, place)] if len(place) == 3 else [float(place[0]), float(place[1]), math.nan]


def _orientation(number: int, feature: Any) -> Array:
    return unit_quaternion(_properties(number, feature).get(ORIENTATION), Member(FEATURE, number, ORIENTATION))


def _covariance_of(size: int) -> Callable[[int, Any], Array]:
    def read(number: int, feature: Any) -> Array:
        told = _properties(number, feature).get(COVARIANCE)
        return square_matrix(told, size, Member(FEATURE, number, COVARIANCE))

    return read


def _arrived_s(number: int, feature: Any) -> float:
    return moment_s(_properties(number, feature).get(ARRIVED), Member(FEATURE, number, ARRIVED))


def _floor(number: int, feature: Any) -> int:
    told: Any = _properties(number, feature).get(FLOOR)
    if not is_number(told) or told != int(told) or abs(told) > GREATEST_FLOOR:
        what = f"{str(told)[:SHOWN]!r} is no storey; storeys are whole numbers"
        raise Member(FEATURE, number, FLOOR).refuse(what)
    return int(told)
