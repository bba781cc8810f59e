"""A room to photograph: a box of walls, floor and ceiling, pictures, furniture, and targets posted on the walls."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.posting import NORTH, POSTER_SIZE_M, PROUD_M, UP, RoomOptions, pose_facing, post_targets
from app.planning.scene import Lamp, Panel, Scene
from app.planning.surfaces import PictureSurface, PlainSurface
from app.planning.tone import linear_of_srgb
from app.targets.family import CodeFamily

Floats = npt.NDArray[np.float64]

WALL_RGB, FLOOR_RGB, CEILING_RGB = (196, 198, 194), (110, 100, 92), (226, 226, 222)
CUPBOARD_RGB, RED_RGB = (92, 62, 46), (205, 30, 34)  # the red thing is there to mislead a reader of red dots
TEXTURE_PX = 256
TEXTURE_CELLS = (4, 16, 64)  # cells of the noise along a wall: shadows, stains, plaster
POSTER_SHAPES = 40
LAMP_RGB = (2.4, 2.3, 2.1)
AMBIENT_RGB = (0.45, 0.45, 0.48)


def build_room(options: RoomOptions, family: CodeFamily, seed: int) -> Scene:
    """A room whose targets carry random codes of the family, none twice.

    Raises
    ------
    ValueError
        When the walls have no room for so many plates.
    """
    rng = np.random.default_rng(seed)
    walls = _walls(options.size_m)
    panels = [plastered(wall, WALL_RGB, rng) for wall in walls]
    panels += [plastered(floor, colour, rng) for floor, colour in _floor_and_ceiling(options.size_m)]
    if options.furniture:
        panels += [_poster(walls[index], rng) for index in (0, 2)] + _furniture(options.size_m)
    codes = rng.choice(family.codes, options.targets + options.wrong_targets, replace=False)
    targets = post_targets(walls, options, codes, rng)
    lamps = tuple(
        Lamp(np.array([options.size_m[0] * share, options.size_m[1] / 2, options.size_m[2] - 0.3]), LAMP_RGB)
        for share in (0.25, 0.75)
    )
    return Scene(targets, tuple(panels), lamps, AMBIENT_RGB)


def _walls(size_m: tuple[float, float, float]) -> list[Panel]:
    """South, east, north, west; each looks into the room."""
    x, y, z = size_m
    plain = PlainSurface(WALL_RGB)
    stands = [
        (x, (0.0, 1.0, 0.0), (x / 2, 0.0, z / 2)),
        (y, (-1.0, 0.0, 0.0), (x, y / 2, z / 2)),
        (x, (0.0, -1.0, 0.0), (x / 2, y, z / 2)),
        (y, (1.0, 0.0, 0.0), (0.0, y / 2, z / 2)),
    ]
    return [Panel(pose_facing(np.array(n), UP, np.array(at)), width, z, plain) for width, n, at in stands]


def _floor_and_ceiling(size_m: tuple[float, float, float]) -> list[tuple[Panel, tuple[int, int, int]]]:
    x, y, z = size_m
    floor = Panel(pose_facing(UP, NORTH, np.array([x / 2, y / 2, 0.0])), x, y, PlainSurface(FLOOR_RGB))
    ceiling = Panel(pose_facing(-UP, NORTH, np.array([x / 2, y / 2, z])), x, y, PlainSurface(CEILING_RGB))
    return [(floor, FLOOR_RGB), (ceiling, CEILING_RGB)]


def plastered(panel: Panel, rgb: tuple[int, int, int], rng: np.random.Generator, roughness: float = 1.0) -> Panel:
    """The panel with smooth noise over its colour, as plaster has it: a few per cent times the roughness."""
    noise = np.zeros((TEXTURE_PX, TEXTURE_PX, 3), dtype=np.float32)
    for cells in TEXTURE_CELLS:
        grid = rng.normal(0.0, 0.03, (cells, cells, 1)) + rng.normal(0.0, 0.008, (cells, cells, 3))
        noise += cv2.resize(grid.astype(np.float32), (TEXTURE_PX, TEXTURE_PX), interpolation=cv2.INTER_CUBIC)
    picture = np.clip(linear_of_srgb(rgb) * (1.0 + roughness * noise), 0.0, 1.0).astype(np.float32)
    surface = PictureSurface(picture, panel.width_m, panel.height_m)
    return Panel(panel.site_from_panel, panel.width_m, panel.height_m, surface)


def _poster(wall: Panel, rng: np.random.Generator) -> Panel:
    """A colourful picture with round shapes in the middle of a wall."""
    picture = np.full((TEXTURE_PX, TEXTURE_PX, 3), 235, dtype=np.uint8)
    for _ in range(POSTER_SHAPES):
        colour = [int(value) for value in rng.integers(0, 256, 3)]
        centre = [int(value) for value in rng.integers(0, TEXTURE_PX, 2)]
        radius = int(rng.integers(3, 22))
        if rng.random() < 0.5:
            cv2.circle(picture, centre, radius, colour, -1, cv2.LINE_AA)
        else:
            cv2.rectangle(picture, centre, [value + radius for value in centre], colour, -1)
    surface = PictureSurface(linear_of_srgb(picture).astype(np.float32), *POSTER_SIZE_M)
    middle = wall.site_from_panel.apply(np.array([0.0, 0.0, PROUD_M]))
    return Panel(Pose(wall.site_from_panel.rotation, middle), *POSTER_SIZE_M, surface)


def _furniture(size_m: tuple[float, float, float]) -> list[Panel]:
    x, y, _ = size_m
    cupboard = box_panels(np.array([0.12 * x, 0.5 * y, 0.55]), (0.5, 0.9, 1.1), CUPBOARD_RGB)
    red_box = box_panels(np.array([0.8 * x, 0.75 * y, 0.2]), (0.3, 0.3, 0.4), RED_RGB)
    return [*cupboard, *red_box]


def box_panels(centre_m: Floats, size_m: tuple[float, float, float], rgb: tuple[int, int, int]) -> list[Panel]:
    """The four sides and the top of a box that stands upright."""
    half_m = np.array(size_m) / 2
    panels = []
    for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1), (2, 1)):
        normal = np.eye(3)[axis] * sign
        up = NORTH if axis == 2 else UP
        width_m, height_m = (size_m[0], size_m[1]) if axis == 2 else (size_m[1 - axis], size_m[2])
        pose = pose_facing(normal, up, centre_m + normal * half_m)
        panels.append(Panel(pose, width_m, height_m, PlainSurface(rgb)))
    return panels
