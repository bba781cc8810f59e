"""What a plan's room looks like: its walls in plaster, a floor and a ceiling, its targets and its lights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.plan_file import Plan
from app.planning.plan_lights import extent_m, lights_of
from app.planning.plan_walls import Wall
from app.planning.posting import NORTH, UP, pose_facing
from app.planning.room import CEILING_RGB, FLOOR_RGB, WALL_RGB, plastered
from app.planning.scene import Panel, Scene
from app.planning.surfaces import PlainSurface

Floats = npt.NDArray[np.float64]

UPRIGHT_COSINE = 0.99
NEAR_M = 0.05  # a floor need not be where the walls end to the millimetre
ROUGHNESS = 0.4  # of painted walls: one per cent of shade


def scene_of(plan: Plan, seed: int) -> Scene:
    """The plan's walls and targets in its light.

    Raises
    ------
    InvalidInput
        Naming line and field of a light that cannot be.
    """
    rng = np.random.default_rng(seed)
    lights = lights_of(plan)
    walls = [panel for wall in plan.walls for panel in _sides(wall, rng)] + _floor_and_ceiling(plan.walls, rng)
    return Scene(plan.targets, (*walls, *lights.panels), lights.lamps, lights.ambient_rgb)


def _sides(wall: Wall, rng: np.random.Generator) -> list[Panel]:
    """Front and back: a wall hides what is behind it from either side."""
    front, turned = wall.site_from_wall, np.diag([-1.0, 1.0, -1.0])
    lying = abs(front.rotation[2, 2]) > UPRIGHT_COSINE
    usual_rgb = (FLOOR_RGB if front.rotation[2, 2] > 0 else CEILING_RGB) if lying else WALL_RGB
    rgb = usual_rgb if wall.rgb is None else wall.rgb
    poses = (front, Pose(front.rotation @ turned, front.position_m))
    plain = [Panel(pose, wall.width_m, wall.height_m, PlainSurface(rgb)) for pose in poses]
    return [plastered(plain[0], rgb, rng, ROUGHNESS), plain[1]]


def _floor_and_ceiling(walls: Sequence[Wall], rng: np.random.Generator) -> list[Panel]:
    """Under and over the upright walls, as a rectangle about them, where the plan has none of its own."""
    upright = [wall for wall in walls if abs(wall.site_from_wall.rotation[2, 2]) <= UPRIGHT_COSINE]
    if not upright:
        return []
    least, greatest = extent_m(upright)
    middle, size = (least + greatest) / 2, greatest - least
    panels = []
    for normal, height_m, rgb in ((UP, least[2], FLOOR_RGB), (-UP, greatest[2], CEILING_RGB)):
        if (size[:2] > 0).all() and not any(_lies_at(wall, normal, height_m) for wall in walls):
            pose = pose_facing(normal, NORTH, np.array([*middle[:2], height_m]))
            plain = Panel(pose, float(size[0]), float(size[1]), PlainSurface(rgb))
            panels.append(plastered(plain, rgb, rng, ROUGHNESS))
    return panels


def _lies_at(wall: Wall, normal: Floats, height_m: float) -> bool:
    """Whether a wall is a floor or ceiling at that height."""
    pose = wall.site_from_wall
    return bool(pose.rotation[:, 2] @ normal > UPRIGHT_COSINE and abs(pose.position_m[2] - height_m) < NEAR_M)
