"""The ``lights`` of a plan: lamps under the ceiling, windows, and light from everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.plan_fields import Field
from app.planning.plan_file import Plan
from app.planning.plan_targets import wall_named
from app.planning.plan_walls import Wall
from app.planning.posting import NORTH, PROUD_M, UP, pose_facing
from app.planning.room import AMBIENT_RGB, CEILING_RGB, LAMP_RGB
from app.planning.scene import Lamp, Panel
from app.planning.surfaces import PlainSurface

Floats = npt.NDArray[np.float64]
Rgb = tuple[float, float, float]

LIGHT_FIELDS = ("ambient", "lamps", "windows")
LAMP_FIELDS = ("at_m", "strength", "size_m")
WINDOW_FIELDS = ("wall", "at_m", "size_m", "glow")
WINDOW_RGB = (60, 66, 74)  # glass mirrors little of a room
DAYLIGHT_RGB = (0.95, 1.0, 1.08)
LAMP_EVERY_M, LAMP_BELOW_M = 5.0, 0.05  # where lamps hang when the plan says nothing
LAMP_SIZE_M = (0.6, 0.6)  # of a usual ceiling's tile
LAMP_STRENGTH, WINDOW_GLOW = 4.0, 2.0
MOST_LAMPS, MOST_LIGHT = 100, 1e4  # each lamp lights each picture element


@dataclass(frozen=True)
class Fixture:
    """A lit sheet under a ceiling.

    Attributes
    ----------
    at_m : ndarray of shape (3,)
    strength : float
        Light on a panel one metre below.
    size_m : tuple of float
        Along x and y.
    """

    at_m: Floats
    strength: float = LAMP_STRENGTH
    size_m: tuple[float, float] = LAMP_SIZE_M

    def lamp(self) -> Lamp:
        """What it does to the others."""
        return Lamp(self.at_m, tinted(self.strength, LAMP_RGB), -UP)

    def panel(self) -> Panel:
        """What is seen of it."""
        # A Lambertian sheet of area A that sends out as much light as a white panel in light L gives L A / pi at 1 m.
        glow = np.pi * self.strength / (self.size_m[0] * self.size_m[1])
        pose = pose_facing(-UP, NORTH, self.at_m)
        return Panel(pose, *self.size_m, PlainSurface(CEILING_RGB), glow_rgb=tinted(glow, LAMP_RGB))


@dataclass(frozen=True)
class Lights:
    """All light of a plan.

    Attributes
    ----------
    ambient_rgb : tuple of float
        From everywhere.
    lamps : tuple of Lamp
    panels : tuple of Panel
        What is seen of lamps and windows.
    """

    ambient_rgb: Rgb
    lamps: tuple[Lamp, ...]
    panels: tuple[Panel, ...]


def lights_of(plan: Plan) -> Lights:
    """What ``lights`` says; what it leaves out is a usual room's.

    Raises
    ------
    InvalidInput
        Naming line and field of a light that cannot be.
    """
    members = plan.sections["lights"].members(*LIGHT_FIELDS) if "lights" in plan.sections else {}
    fixtures = _fixtures(members["lamps"]) if "lamps" in members else _usual_fixtures(plan.walls)
    windows = [_window(window, plan) for window in (members["windows"].items() if "windows" in members else [])]
    level = members["ambient"].positive(MOST_LIGHT) if "ambient" in members else max(AMBIENT_RGB)
    return Lights(
        ambient_rgb=tinted(level, AMBIENT_RGB),
        lamps=tuple(fixture.lamp() for fixture in fixtures),
        panels=(*windows, *(fixture.panel() for fixture in fixtures)),
    )


def tinted(level: float, colour: Rgb) -> Rgb:
    """Light of a colour whose strongest channel has that level."""
    red, green, blue = (level / max(colour) * np.array(colour)).tolist()
    return red, green, blue


def extent_m(walls: Sequence[Wall]) -> tuple[Floats, Floats]:
    """Least and greatest coordinates of walls, each of shape (3,)."""
    corners_m = np.concatenate([wall.corners_m() for wall in walls])
    return corners_m.min(axis=0), corners_m.max(axis=0)


def _fixtures(section: Field) -> list[Fixture]:
    items = section.items()
    if len(items) > MOST_LAMPS:
        raise section.error(f"at most {MOST_LAMPS} lamps; a larger ambient light stands for many")
    fixtures = []
    for item in items:
        members = item.members(*LAMP_FIELDS)
        strength = members["strength"].positive(MOST_LIGHT) if "strength" in members else LAMP_STRENGTH
        size_m = _size(members["size_m"]) if "size_m" in members else LAMP_SIZE_M
        fixtures.append(Fixture(item.needed(members, "at_m").vector(3), strength, size_m))
    return fixtures


def _usual_fixtures(walls: Sequence[Wall]) -> list[Fixture]:
    """In rows below the ceiling."""
    if not walls:
        return []
    least, greatest = extent_m(walls)
    across, along = (
        low + (np.arange(rows) + 0.5) / rows * (high - low)
        for low, high in zip(least[:2], greatest[:2], strict=True)
        for rows in (max(1, round((high - low) / LAMP_EVERY_M)),)
    )
    return [Fixture(np.array([x_m, y_m, greatest[2] - LAMP_BELOW_M])) for x_m in across for y_m in along]


def _window(item: Field, plan: Plan) -> Panel:
    """A bright rectangle on a wall; metering follows it, as a phone's does."""
    members = item.members(*WINDOW_FIELDS)
    wall = wall_named(item.needed(members, "wall"), {wall.name: wall for wall in plan.walls})
    at = item.needed(members, "at_m")
    along_m, up_m = at.vector(2).tolist()
    size_m = _size(item.needed(members, "size_m"))
    margins_m = (
        np.array([along_m, up_m, wall.width_m - along_m, wall.height_m - up_m]) - np.array([*size_m, *size_m]) / 2
    )
    if (margins_m < 0).any():
        raise at.error(f"at_m is the window's middle, and the window reaches beyond the wall {wall.name}")
    glow = members["glow"].positive(MOST_LIGHT) if "glow" in members else WINDOW_GLOW
    # Between the wall and the paper that hangs on it.
    at_m = wall.place_m(along_m, up_m) - PROUD_M / 2 * wall.site_from_wall.rotation[:, 2]
    pose = Pose(wall.site_from_wall.rotation, at_m)
    for target in plan.targets:
        x_m, y_m, z_m = np.abs(pose.inverse().apply(target.site_from_target.position_m))
        if z_m <= PROUD_M and x_m <= size_m[0] / 2 and y_m <= size_m[1] / 2:
            raise item.error(f"the target {target.code} hangs on this window: move one of them")
    return Panel(pose, *size_m, PlainSurface(WINDOW_RGB), glow_rgb=tinted(glow, DAYLIGHT_RGB))


def _size(field: Field) -> tuple[float, float]:
    width_m, height_m = field.vector(2).tolist()
    if not (width_m > 0 and height_m > 0):
        raise field.error("two positive lengths are needed")
    return width_m, height_m
