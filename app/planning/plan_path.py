"""The ``path`` of a plan: where the survey's photographs and the snapshots are taken from, and a walk."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.plan_fields import Field
from app.planning.survey_plan import StationOptions, look_at, plan_stations
from app.planning.walk import Gaze, Walk, WalkOptions, plan_walk

Floats = npt.NDArray[np.float64]

PATH_FIELDS = ("start", "survey", "locate", "walk")
RING, STATION = ("ring",), ("at_m", "look_at_m", "headings_deg", "pitch_deg", "roll_deg")
RING_FIELDS = ("count", "centre_m", "radii_m", "height_m", "aim_jitter_deg", "upright_every")
GAZE_FIELDS = ("look_at_m", "look_aside_deg", "pitch_deg", "roll_deg")
WALK_FIELDS = ("waypoints_m", "height_m", "every_s", "speed_m_s", "unsteady_deg", *GAZE_FIELDS)
EXAMPLE_TIME = "2026-03-02T09:00:00Z"
MOST_PHOTOS = 5_000  # of one path
LATEST = datetime(9998, 1, 1, tzinfo=UTC).timestamp()
STEEPEST_DEG, LONGEST_S = 85.0, 3600.0


@dataclass(frozen=True)
class Pacing:
    """The clock of the photographer.

    Attributes
    ----------
    station_s : float
        From one station's photograph to the next.
    pause_s : float
        Between survey, snapshots and walk.
    """

    station_s: float = 5.0
    pause_s: float = 60.0


@dataclass(frozen=True)
class Stop:
    """One photograph to be taken.

    Attributes
    ----------
    name : str
        Of its file.
    site_from_cam : Pose
        At mid-exposure.
    time_s : float
        Mid-exposure, UTC, seconds since 1970.
    walk_s : float or None
        Seconds since the walk's start; None of a station.
    """

    name: str
    site_from_cam: Pose
    time_s: float
    walk_s: float | None = None


@dataclass(frozen=True)
class Path:
    """All photographs of a plan.

    Attributes
    ----------
    survey, snapshots : tuple of Stop
        Those that the map is built from, and those to locate, stations before the walk.
    walk : Walk or None
    """

    survey: tuple[Stop, ...]
    snapshots: tuple[Stop, ...]
    walk: Walk | None


def read_path(section: Field, seed: int, pacing: Pacing | None = None) -> Path:
    """The object ``path``.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    pacing = pacing or Pacing()
    members = section.members(*PATH_FIELDS)
    start_s = _time_s(members["start"]) if "start" in members else _iso_s(EXAMPLE_TIME)
    survey = _stations(section.needed(members, "survey"), start_s, seed, pacing)
    snapshots: tuple[Stop, ...] = ()
    if "locate" in members:
        snapshots = _stations(members["locate"], survey[-1].time_s + pacing.pause_s, seed + 1, pacing)
    if "walk" not in members:
        return Path(survey, snapshots, None)
    walk, every_s = _walk(members["walk"], seed)
    begin_s = (*survey, *snapshots)[-1].time_s + pacing.pause_s
    return Path(survey, (*snapshots, *_on_the_way(walk, every_s, begin_s)), walk)


def _stations(section: Field, start_s: float, seed: int, pacing: Pacing) -> tuple[Stop, ...]:
    poses: list[Pose] = []
    for item in section.items():
        members = item.members(*RING, *STATION)
        if "ring" in members and len(members) > 1:
            raise item.error("a ring stands alone: begin a new item for a station")
        poses += _ring(members["ring"], seed + len(poses)) if "ring" in members else _station(item, members)
        if len(poses) > MOST_PHOTOS:
            raise item.error(f"at most {MOST_PHOTOS} photographs")
    if not poses:
        raise section.error("at least one station is needed, as - ring: {count: 20, centre_m: [3, 2], radii_m: [2, 1]}")
    return tuple(
        Stop(f"IMG_{index:04d}.jpg", pose, start_s + index * pacing.station_s) for index, pose in enumerate(poses)
    )


def _ring(ring: Field, seed: int) -> list[Pose]:
    members = ring.members(*RING_FIELDS)
    centre_m = ring.needed(members, "centre_m").vector(2)
    radii_m = ring.needed(members, "radii_m").vector(2)
    if not (radii_m > 0).all():
        raise members["radii_m"].error("two positive radii are needed, along x and along y")
    usual = StationOptions(ring_share=1.0)
    jitter_rad = np.radians(members["aim_jitter_deg"].number(0.0, 45.0)) if "aim_jitter_deg" in members else None
    options = replace(
        usual,
        count=ring.needed(members, "count").integer(1, MOST_PHOTOS),
        height_m=members["height_m"].number() if "height_m" in members else usual.height_m,
        aim_jitter_rad=usual.aim_jitter_rad if jitter_rad is None else float(jitter_rad),
        upright_every=members["upright_every"].integer(0, MOST_PHOTOS) if "upright_every" in members else 4,
    )
    # The planner's ellipse lies in the middle of a room that begins at the origin: it is moved to the wished centre.
    moved_m = np.append(centre_m - radii_m, 0.0)
    poses = plan_stations((2.0 * radii_m[0], 2.0 * radii_m[1], 0.0), options, seed)
    return [Pose(pose.rotation, pose.position_m + moved_m) for pose in poses]


def _station(item: Field, members: dict[str, Field]) -> list[Pose]:
    """One photograph for each heading, or one that looks at a place."""
    position_m = item.needed(members, "at_m").vector(3)
    roll_rad = _radians(members, "roll_deg", 180.0)
    if ("look_at_m" in members) == ("headings_deg" in members):
        raise item.error("say where it looks: look_at_m, or headings_deg (0 along x, 90 along y; one photograph each)")
    if "look_at_m" in members:
        aim = members["look_at_m"]
        try:
            return [look_at(position_m, _elsewhere(aim, position_m), roll_rad)]
        except ValueError as error:
            raise aim.error(str(error)) from error
    up_rad = _radians(members, "pitch_deg", STEEPEST_DEG)
    headings_rad = np.radians([heading.number() for heading in members["headings_deg"].items()])
    ways = np.column_stack([np.cos(headings_rad), np.sin(headings_rad), np.full(len(headings_rad), np.tan(up_rad))])
    return [look_at(position_m, position_m + way, roll_rad) for way in ways]


def _walk(section: Field, seed: int) -> tuple[Walk, float]:
    members = section.members(*WALK_FIELDS)
    usual = WalkOptions()
    options = replace(
        usual,
        speed_m_s=members["speed_m_s"].number(0.05, 5.0) if "speed_m_s" in members else usual.speed_m_s,
        unsteady_rad=_radians(members, "unsteady_deg", 20.0, usual.unsteady_rad),
    )
    gaze = Gaze(
        at_m=members["look_at_m"].vector(3) if "look_at_m" in members else None,
        aside_rad=_radians(members, "look_aside_deg", 180.0),
        up_rad=_radians(members, "pitch_deg", STEEPEST_DEG),
        roll_rad=_radians(members, "roll_deg", 180.0),
    )
    if gaze.at_m is not None and not {"look_aside_deg", "pitch_deg"}.isdisjoint(members):
        raise section.error("look_at_m says it all: leave out look_aside_deg and pitch_deg")
    height_m = members["height_m"].number() if "height_m" in members else StationOptions().height_m
    waypoints = section.needed(members, "waypoints_m")
    places = [place.vector(2, 3) for place in waypoints.items()]
    path_m = np.array([place if len(place) > 2 else np.append(place, height_m) for place in places]).reshape(-1, 3)
    try:
        walk = plan_walk(path_m, gaze, options, seed)
    except ValueError as error:
        raise waypoints.error(str(error)) from error
    if walk.duration_s > LONGEST_S:
        raise waypoints.error(f"a walk of {walk.duration_s:.0f} s is longer than {LONGEST_S:g} s: cut it short")
    every_s = members["every_s"].number(0.01, LONGEST_S) if "every_s" in members else 1.0
    if walk.duration_s / every_s > MOST_PHOTOS:
        raise section.error(f"more than {MOST_PHOTOS} photographs: take them less often (every_s)")
    return walk, every_s


def _on_the_way(walk: Walk, every_s: float, begin_s: float) -> list[Stop]:
    times_s = np.arange(int(walk.duration_s / every_s) + 1) * every_s
    return [
        Stop(f"WALK_{index:04d}.jpg", walk.pose_at(time_s), begin_s + time_s, time_s)
        for index, time_s in enumerate(times_s.tolist())
    ]


def _elsewhere(aim: Field, position_m: Floats) -> Floats:
    aim_m = aim.vector(3)
    if np.array_equal(aim_m, position_m):
        raise aim.error("the camera cannot look at the place where it is")
    return aim_m


def _radians(members: dict[str, Field], name: str, greatest_deg: float, usual_rad: float = 0.0) -> float:
    return float(np.radians(members[name].number(-greatest_deg, greatest_deg))) if name in members else usual_rad


def _time_s(field: Field) -> float:
    try:
        time_s = _iso_s(field.text().strip())
    except ValueError:
        raise field.error(f"a time is needed, as {EXAMPLE_TIME}") from None
    if not 0.0 <= time_s <= LATEST:
        raise field.error("a time between 1970 and 9998 is needed")
    return time_s


def _iso_s(text: str) -> float:
    """UTC seconds since 1970; without a zone the time is UTC."""
    moment = datetime.fromisoformat(text)
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
