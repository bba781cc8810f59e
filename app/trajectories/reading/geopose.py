"""OGC GeoPose: a list of Basic-Quaternion poses, each with the time that the standard's advanced form has."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.trajectories.reading.json_values import (
    GeodeticPoses,
    Member,
    document_of,
    increasing,
    is_number,
    listed,
    unit_quaternion,
)
from app.trajectories.trajectory import Array

POSE, TIME = "pose", "validTime"
PLACE, TURN = ("lon", "lat", "h"), ("x", "y", "z", "w")
MILLISECONDS = 1e3


def read_geopose(data: bytes) -> GeodeticPoses:
    """Poses ``{position: {lat, lon, h}, quaternion: {x, y, z, w}, validTime}``, such as this project writes.

    ``validTime`` counts milliseconds since 1970. Orientations are against east, north and up.

    Raises
    ------
    UnreadableTrajectory
        Naming the pose (from 1) and its member.

    Notes
    -----
    OGC 21-056r11, Basic-Quaternion. A single pose may stand without a list around it.
    """
    document = document_of(data)
    found = listed([document] if isinstance(document, dict) else document, "list of GeoPoses")
    times_s = np.array([_time_s(number, pose) for number, pose in enumerate(found, start=1)])
    increasing(times_s, POSE, TIME)
    places = np.array([_place(number, pose) for number, pose in enumerate(found, start=1)])
    return GeodeticPoses(times_s, places, np.array([_turn(number, pose) for number, pose in enumerate(found, start=1)]))


def _time_s(number: int, pose: Any) -> float:
    told = pose.get(TIME) if isinstance(pose, dict) else None
    if not is_number(told):
        raise Member(POSE, number, TIME).refuse("a pose needs its time: milliseconds since 1970")
    assert told is not None
    return float(told) / MILLISECONDS


def _place(number: int, pose: Any) -> list[float]:
    longitude_deg, latitude_deg, height_m = _numbers(pose, "position", PLACE, number)
    if abs(longitude_deg) > 180 or abs(latitude_deg) > 90:
        raise Member(POSE, number, "position").refuse(f"{latitude_deg:g}, {longitude_deg:g} is no place in degrees")
    return [longitude_deg, latitude_deg, height_m]


def _turn(number: int, pose: Any) -> Array:
    return unit_quaternion(_numbers(pose, "quaternion", TURN, number), Member(POSE, number, "quaternion"))


def _numbers(pose: Any, name: str, parts: tuple[str, ...], number: int) -> list[float]:
    held = pose.get(name)
    values: list[Any] = [held.get(part) if isinstance(held, dict) else None for part in parts]
    if not all(is_number(value) for value in values):
        raise Member(POSE, number, name).refuse(f"the numbers {', '.join(parts)} are needed")
    return values
