"""A synthetic building: wings of rooms on both sides of a corridor, joined by a cross corridor, plates on all walls.

Nothing has pixels: a building is where plates hang, where walls stop the view and where photographs are taken from.
The axes are east (along the wings), north (along the cross corridor) and up; the first wing begins at the origin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.survey_plan import look_at
from app.targets.family import family_by_name

Array = npt.NDArray[np.float64]

FAMILY = "parity"  # 59,048 codes: golay has 728 and hamming 6,560, too few for 10,000 plates
UP = np.array([0.0, 0.0, 1.0])
RING_SHARE = 0.42  # of a room's sides: its photographs stand near the walls and look across
PROUD_M = 0.02  # of the wall: a plate on a board, so that its own wall does not stand before it
QUARTER_TURN_RAD = np.pi / 2.0


@dataclass(frozen=True)
class BuildingOptions:
    """Sizes in metres; counts per room, per bay (a stretch of corridor with a room on either side) and of the whole.

    Attributes
    ----------
    wings, bays : int
        Wings, and bays of each. Without wings there is the cross corridor alone, ``lone_corridor_m`` long.
    room_plates, room_photos : int
        In each room; its photographs stand on a ring and look across.
    door_photos : int
        Through each door, one half from the corridor and one half from within.
    corridor_plates, corridor_photos : int
        Of each bay.
    cross_plates, cross_photos : int
        Of the cross corridor.
    bay_m, room_m, corridor_m, door_m : float
        Length of a bay, depth of its rooms, breadth of corridors and doors.
    cross_end_m : float
        How far the cross corridor reaches beyond the outer wings.
    lone_corridor_m : float
        Length of the cross corridor where there are no wings.
    lowest_m, highest_m : float
        Plates' centres above the floor.
    tilt_rad : float
        Standard deviation of how crooked plates hang.
    eye_m, eye_jitter_m : float
        Height of the photographs, and its scatter.
    aim_jitter_rad : float
        Scatter of where they look.
    upright_every : int
        Every so many photographs the phone is turned upright, which a self-calibration needs.
    lengthwise : bool
        Whether every fourth photograph of a corridor looks along it; if not, each shows the wall across alone.
    """

    wings: int = 1
    bays: int = 1
    room_plates: int = 32
    room_photos: int = 12
    door_photos: int = 4
    corridor_plates: int = 32
    corridor_photos: int = 16
    cross_plates: int = 20
    cross_photos: int = 6
    bay_m: float = 8.0
    room_m: float = 6.0
    corridor_m: float = 3.0
    door_m: float = 1.2
    cross_end_m: float = 3.0
    lone_corridor_m: float = 60.0
    lowest_m: float = 0.6
    highest_m: float = 2.3
    tilt_rad: float = 0.05
    eye_m: float = 1.5
    eye_jitter_m: float = 0.15
    aim_jitter_rad: float = 0.1
    upright_every: int = 4
    lengthwise: bool = True

    @property
    def pitch_m(self) -> float:
        """From one wing to the next: their rooms stand back to back."""
        return 2.0 * self.room_m + self.corridor_m

    @property
    def cross_m(self) -> tuple[float, float]:
        """South and north end of the cross corridor."""
        if not self.wings:
            return -self.lone_corridor_m / 2.0, self.lone_corridor_m / 2.0
        return -self.cross_end_m, (self.wings - 1) * self.pitch_m + self.cross_end_m


@dataclass(frozen=True)
class Building:
    """What stands: plates by code (``site_from_target``), walls in plan (W, 2, 2), m, true poses of photographs."""

    plates: dict[int, Pose]
    walls_m: Array
    stations: tuple[Pose, ...]


@dataclass(frozen=True)
class _Wall:
    """A wall with plates: its ends in plan, left to right as its reader sees it, and the door's range along it."""

    start_m: Array
    end_m: Array
    plates: int
    door_m: tuple[float, float] | None = None

    @property
    def ahead(self) -> Array:
        along = self.end_m - self.start_m
        return np.asarray(along / np.linalg.norm(along))

    @property
    def pieces_m(self) -> list[tuple[Array, Array]]:
        """What blocks the view: the wall on either side of its door."""
        if self.door_m is None:
            return [(self.start_m, self.end_m)]
        left, right = (self.start_m + at * self.ahead for at in self.door_m)
        return [(self.start_m, left), (right, self.end_m)]


def build_building(options: BuildingOptions, seed: int) -> Building:
    """A building with codes in the order of its walls, all from one seed."""
    rng = np.random.default_rng(seed)
    walls = list(_walls(options))
    places = [place for wall in walls for place in _plates(wall, options, rng)]
    codes = family_by_name(FAMILY).codes[: len(places)].tolist()
    segments = np.array([piece for wall in walls for piece in wall.pieces_m])
    return Building(dict(zip(codes, places, strict=True)), segments, tuple(_stations(options, rng)))


def _walls(options: BuildingOptions) -> Iterator[_Wall]:
    yield from _cross_walls(options)
    for wing in range(options.wings):
        for bay in range(options.bays):
            corner_m = np.array([bay * options.bay_m, wing * options.pitch_m])
            for side in (1.0, -1.0):
                yield from _bay_walls(options, corner_m, side)


def _cross_walls(options: BuildingOptions) -> Iterator[_Wall]:
    """The cross corridor's west wall, and its east wall in pieces between the wings' corridors."""
    south, north = options.cross_m
    half = options.cross_plates // 2
    yield _Wall(
        np.array([-options.corridor_m, south]), np.array([-options.corridor_m, north]), options.cross_plates - half
    )
    mouths = [
        wing * options.pitch_m + side * options.corridor_m / 2.0 for wing in range(options.wings) for side in (-1, 1)
    ]
    ends = [south, *mouths, north]
    pieces = list(zip(ends[::2], ends[1::2], strict=True))[::-1]
    for place, (low, high) in enumerate(pieces):
        share = half // len(pieces) + (place < half % len(pieces))
        yield _Wall(np.array([0.0, high]), np.array([0.0, low]), share)


def _bay_walls(options: BuildingOptions, corner_m: Array, side: float) -> Iterator[_Wall]:
    """One side of a bay: the corridor's wall with the door, read from the corridor, and the room's four walls."""
    near, far = side * options.corridor_m / 2.0, side * (options.corridor_m / 2.0 + options.room_m)
    west, east = corner_m + np.array([0.0, near]), corner_m + np.array([options.bay_m, near])
    far_west, far_east = corner_m + np.array([0.0, far]), corner_m + np.array([options.bay_m, far])
    door = (options.bay_m - options.door_m) / 2.0, (options.bay_m + options.door_m) / 2.0
    quarter = options.room_plates // 4
    # Whoever faces south has west on his right.
    outer, inner = ((west, east), (east, west)) if side > 0 else ((east, west), (west, east))
    across = (far_west, far_east) if side > 0 else (far_east, far_west)
    west_wall = (west, far_west) if side > 0 else (far_west, west)
    east_wall = (far_east, east) if side > 0 else (east, far_east)
    yield _Wall(*outer, options.corridor_plates // 2, door)
    yield _Wall(*inner, quarter, door)
    for ends in (across, west_wall, east_wall):
        yield _Wall(*ends, quarter)


def _plates(wall: _Wall, options: BuildingOptions, rng: np.random.Generator) -> Iterator[Pose]:
    """Plates spread along a wall beside its door, at random heights; they face to the right of its direction."""
    length_m = float(np.linalg.norm(wall.end_m - wall.start_m))
    gap = wall.door_m or (length_m, length_m)
    free_m = length_m - (gap[1] - gap[0])
    inwards = np.array([wall.ahead[1], -wall.ahead[0], 0.0])
    upright = np.stack([np.cross(UP, inwards), UP, inwards], axis=-1)
    for number in range(wall.plates):
        at_m = free_m * (number + rng.uniform(0.25, 0.75)) / wall.plates
        at_m += (gap[1] - gap[0]) * (at_m > gap[0])
        plan_m = wall.start_m + at_m * wall.ahead + PROUD_M * inwards[:2]
        position_m = np.array([*plan_m, rng.uniform(options.lowest_m, options.highest_m)])
        yield Pose(upright @ exp_rotation(rng.normal(0.0, options.tilt_rad, 3)), position_m)


def _stations(options: BuildingOptions, rng: np.random.Generator) -> Iterator[Pose]:
    """Photographs of the cross corridor, then of each wing bay by bay."""
    south, north = options.cross_m
    middle = np.array([-options.corridor_m / 2.0, 0.0])
    for number in range(options.cross_photos):
        at_m = middle + np.array([0.0, south + (north - south) * (number + 0.5) / options.cross_photos])
        yield _corridor_station(at_m, QUARTER_TURN_RAD, number, (options, rng))
    for wing in range(options.wings):
        for bay in range(options.bays):
            yield from _bay_stations(options, np.array([bay * options.bay_m, wing * options.pitch_m]), rng)


def _bay_stations(options: BuildingOptions, corner_m: Array, rng: np.random.Generator) -> Iterator[Pose]:
    for number in range(options.corridor_photos):
        at_m = corner_m + np.array([options.bay_m * (number + 0.5) / options.corridor_photos, 0.0])
        yield _corridor_station(at_m, 0.0, number, (options, rng))
    for side in (1.0, -1.0):
        room_m = corner_m + np.array([options.bay_m / 2.0, side * (options.corridor_m + options.room_m) / 2.0])
        radii_m = RING_SHARE * np.array([options.bay_m, options.room_m])
        for number in range(options.room_photos):
            angle = 2.0 * np.pi * number / options.room_photos
            outwards = np.array([np.cos(angle), np.sin(angle)])
            yield _station(room_m + outwards * radii_m, np.arctan2(-outwards[1], -outwards[0]), number, (options, rng))
        door_m = corner_m + np.array([options.bay_m / 2.0, side * options.corridor_m / 2.0])
        for number in range(options.door_photos):
            # One from the corridor's other side looks in, the next from within looks out.
            towards = side * (1.0 if number % 2 == 0 else -1.0)
            aside_m = 0.3 * rng.uniform(-1.0, 1.0)
            yield _station(door_m + np.array([aside_m, -1.0 * towards]), towards * QUARTER_TURN_RAD, 1, (options, rng))


# Off a wall's normal: obliquely either way, along the corridor, which ties its walls together, and nearly across.
ASIDE_RAD = tuple(np.deg2rad([30.0, -30.0, 90.0, 10.0]))
WALL_BY_WALL_RAD = tuple(np.deg2rad([30.0, -30.0, -10.0, 10.0]))
FROM_WALL_M = 0.5


def _corridor_station(
    at_m: Array, along_rad: float, number: int, how: tuple[BuildingOptions, np.random.Generator]
) -> Pose:
    """A photograph in a corridor: from one wall to the other, the walls in turn."""
    side = 1.0 if number % 2 == 0 else -1.0
    facing_rad = along_rad + side * QUARTER_TURN_RAD
    back_m = (how[0].corridor_m / 2.0 - FROM_WALL_M) * np.array([np.cos(facing_rad), np.sin(facing_rad)])
    aside_rad = ASIDE_RAD if how[0].lengthwise else WALL_BY_WALL_RAD
    return _station(at_m - back_m, facing_rad + aside_rad[number // 2 % len(aside_rad)], number // 2, how)


def _station(at_m: Array, heading_rad: float, number: int, how: tuple[BuildingOptions, np.random.Generator]) -> Pose:
    options, rng = how
    position_m = np.array(
        [*(at_m + rng.uniform(-0.15, 0.15, 2)), options.eye_m + rng.normal(0.0, options.eye_jitter_m)]
    )
    heading = heading_rad + rng.normal(0.0, options.aim_jitter_rad)
    aim_m = position_m + np.array([np.cos(heading), np.sin(heading), rng.normal(0.0, options.aim_jitter_rad)])
    roll_rad = rng.normal(0.0, options.aim_jitter_rad)
    roll_rad += QUARTER_TURN_RAD * ((number + 1) % options.upright_every == 0)
    return look_at(position_m, aim_m, roll_rad)
