"""What a plan's room looks like: its walls in plaster, a floor and a ceiling, and its ``lights``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.plan_fields import Field
from app.planning.plan_file import Plan
from app.planning.plan_targets import wall_named
from app.planning.plan_walls import Wall
from app.planning.posting import NORTH, PROUD_M, UP, pose_facing
from app.planning.room import AMBIENT_RGB, CEILING_RGB, FLOOR_RGB, LAMP_RGB, WALL_RGB, plastered
from app.planning.scene import Lamp, Panel, Scene
from app.planning.surfaces import PlainSurface

Floats = npt.NDArray[np.float64]

LIGHT_FIELDS = ("ambient", "lamps", "windows")
LAMP_FIELDS = ("at_m", "strength")
WINDOW_FIELDS = ("wall", "at_m", "size_m", "glow")
WINDOW_RGB = (60, 66, 74)  # glass mirrors little of a room
DAYLIGHT_RGB = (0.95, 1.0, 1.08)
LAMP_EVERY_M, LAMP_BELOW_M = 5.0, 0.3  # where lamps hang when the plan says nothing
UPRIGHT_COSINE = 0.99
MOST_LAMPS, MOST_LIGHT = 100, 1e4  # each lamp lights each picture element


def scene_of(plan: Plan, seed: int) -> Scene:
    """The plan's walls and targets in its light.

    Raises
    ------
    InvalidInput
        Naming line and field of a light that cannot be.
    """
    rng = np.random.default_rng(seed)
    members = plan.sections["lights"].members(*LIGHT_FIELDS) if "lights" in plan.sections else {}
    windows = members["windows"].items() if "windows" in members else []
    by_name = {wall.name: wall for wall in plan.walls}
    panels = [panel for wall in plan.walls for panel in _sides(wall, rng)]
    panels += _floor_and_ceiling(plan.walls, rng) + [_window(window, by_name) for window in windows]
    ambient = AMBIENT_RGB
    if "ambient" in members:
        red, green, blue = (members["ambient"].positive(MOST_LIGHT) / max(AMBIENT_RGB) * np.array(AMBIENT_RGB)).tolist()
        ambient = (red, green, blue)
    lamps = _lamps(members["lamps"]) if "lamps" in members else _usual_lamps(plan.walls)
    return Scene(plan.targets, tuple(panels), lamps, ambient)


def _sides(wall: Wall, rng: np.random.Generator) -> list[Panel]:
    """Front and back: a wall hides what is behind it from either side."""
    front, turned = wall.site_from_wall, np.diag([-1.0, 1.0, -1.0])
    lying = abs(front.rotation[2, 2]) > UPRIGHT_COSINE
    usual_rgb = (FLOOR_RGB if front.rotation[2, 2] > 0 else CEILING_RGB) if lying else WALL_RGB
    rgb = usual_rgb if wall.rgb is None else wall.rgb
    poses = (front, Pose(front.rotation @ turned, front.position_m))
    plain = [Panel(pose, wall.width_m, wall.height_m, PlainSurface(rgb)) for pose in poses]
    return [plastered(plain[0], rgb, rng), plain[1]]


def _floor_and_ceiling(walls: Sequence[Wall], rng: np.random.Generator) -> list[Panel]:
    """Under and over the upright walls, as a rectangle about them, when the plan has no lying walls of its own."""
    upright = [wall for wall in walls if abs(wall.site_from_wall.rotation[2, 2]) <= UPRIGHT_COSINE]
    if not upright or len(upright) < len(walls):
        return []
    least, greatest = extent_m(upright)
    middle, size = (least + greatest) / 2, greatest - least
    panels = []
    for normal, height_m, rgb in ((UP, least[2], FLOOR_RGB), (-UP, greatest[2], CEILING_RGB)):
        if (size[:2] > 0).all():
            pose = pose_facing(normal, NORTH, np.array([*middle[:2], height_m]))
            panels.append(plastered(Panel(pose, float(size[0]), float(size[1]), PlainSurface(rgb)), rgb, rng))
    return panels


def extent_m(walls: Sequence[Wall]) -> tuple[Floats, Floats]:
    """Least and greatest coordinates of walls, each of shape (3,)."""
    corners_m = np.concatenate([wall.corners_m() for wall in walls])
    return corners_m.min(axis=0), corners_m.max(axis=0)


def _lamps(section: Field) -> tuple[Lamp, ...]:
    items = section.items()
    if len(items) > MOST_LAMPS:
        raise section.error(f"at most {MOST_LAMPS} lamps; a larger ambient light stands for many")
    lamps = []
    for item in items:
        members = item.members(*LAMP_FIELDS)
        strength = members["strength"].positive(MOST_LIGHT) if "strength" in members else max(LAMP_RGB)
        red, green, blue = (strength / max(LAMP_RGB) * np.array(LAMP_RGB)).tolist()
        lamps.append(Lamp(item.needed(members, "at_m").vector(3), (red, green, blue)))
    return tuple(lamps)


def _usual_lamps(walls: Sequence[Wall]) -> tuple[Lamp, ...]:
    """In rows below the ceiling."""
    if not walls:
        return ()
    least, greatest = extent_m(walls)
    rows = [max(1, round((high - low) / LAMP_EVERY_M)) for low, high in zip(least[:2], greatest[:2], strict=True)]
    grid = [low + (np.arange(n) + 0.5) / n * (high - low) for n, low, high in zip(rows, least, greatest, strict=False)]
    height_m = greatest[2] - LAMP_BELOW_M
    return tuple(Lamp(np.array([x_m, y_m, height_m]), LAMP_RGB) for x_m in grid[0] for y_m in grid[1])


def _window(item: Field, walls: dict[str, Wall]) -> Panel:
    """A bright rectangle on a wall; metering follows it, as a phone's does."""
    members = item.members(*WINDOW_FIELDS)
    wall = wall_named(item.needed(members, "wall"), walls)
    along_m, up_m = item.needed(members, "at_m").vector(2)
    size = item.needed(members, "size_m")
    width_m, height_m = size.vector(2)
    if not (width_m > 0 and height_m > 0):
        raise size.error("a window has a positive width and height")
    if not (
        width_m / 2 <= along_m <= wall.width_m - width_m / 2 and height_m / 2 <= up_m <= wall.height_m - height_m / 2
    ):
        raise members["at_m"].error(f"the window's middle is at_m; it reaches beyond the wall {wall.name}")
    glow = members["glow"].positive(MOST_LIGHT) if "glow" in members else 2.0
    red, green, blue = (glow * np.array(DAYLIGHT_RGB)).tolist()
    middle_m = wall.place_m(along_m, up_m) - PROUD_M / 2 * wall.site_from_wall.rotation[:, 2]
    pose = Pose(wall.site_from_wall.rotation, middle_m)
    return Panel(pose, float(width_m), float(height_m), PlainSurface(WINDOW_RGB), glow_rgb=(red, green, blue))
