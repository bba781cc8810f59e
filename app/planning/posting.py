"""Targets posted on walls: at random places, hanging a little askew, no sheet over another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.scene import DEFAULT_PAPER_MARGIN_U, Panel, PostedTarget
from app.targets.drawing import cell_colours_rgb
from app.targets.layout import BASE_CELLS, DEFAULT_U_M, PLATE_SIDE_U

Floats = npt.NDArray[np.float64]
Codes = npt.NDArray[np.int64]

UP = np.array([0.0, 0.0, 1.0])
NORTH = np.array([0.0, 1.0, 0.0])  # stands for 'up' on floor and ceiling

POSTER_SIZE_M = (0.7, 0.5)
PROUD_M = 0.001  # how far paper stands off the wall
POST_TRIES = 50  # per plate, before the walls are called full
OFF_DIAGONAL_CELLS = (1, 2, 4, 7, 8, 11, 13, 14)  # where E makes a target in no orientation


@dataclass(frozen=True)
class RoomOptions:
    """What a synthetic room looks like.

    Attributes
    ----------
    size_m : tuple of float
        Along x, y and z; the site's origin is a corner of the floor.
    targets : int
        How many are posted, spread at random over the walls.
    wrong_targets : int
        Plates of wrong structure among them.
    u_m : float
        Module of all plates.
    roll_deg : float
        Plates hang up to so much askew.
    heights_m : tuple of float
        Between which heights the plates' middles hang.
    walls : tuple of int
        Which walls carry plates: 0 south (y = 0), 1 east, 2 north, 3 west (x = 0).
    furniture : bool
        Whether a cupboard, a red box and posters stand there.
    """

    size_m: tuple[float, float, float] = (5.0, 4.0, 2.6)
    targets: int = 40
    wrong_targets: int = 0
    u_m: float = DEFAULT_U_M
    roll_deg: float = 12.0
    heights_m: tuple[float, float] = (0.5, 2.2)
    walls: tuple[int, ...] = (0, 1, 2, 3)
    furniture: bool = True


def pose_facing(normal: Floats, up: Floats, position_m: Floats, roll_rad: float = 0.0) -> Pose:
    """Pose ``site_from_panel`` of a panel whose front looks along ``normal``, turned counter-clockwise by ``roll``."""
    z_axis = normal / np.linalg.norm(normal)
    x_axis = np.cross(up, z_axis)
    x_axis /= np.linalg.norm(x_axis)
    y_axis = np.cross(z_axis, x_axis)
    cosine, sine = np.cos(roll_rad), np.sin(roll_rad)
    rotation = np.column_stack([cosine * x_axis + sine * y_axis, cosine * y_axis - sine * x_axis, z_axis])
    return Pose(rotation, np.asarray(position_m, dtype=np.float64))


def post_targets(
    walls: list[Panel], options: RoomOptions, codes: Codes, rng: np.random.Generator
) -> tuple[PostedTarget, ...]:
    """A plate for each code; those after the first ``options.targets`` have a wrong structure.

    Raises
    ------
    ValueError
        When the walls have no room for so many plates.
    """
    places = _places(walls, options, len(codes), rng)
    targets = []
    for index, (wall, place_m) in enumerate(places):
        roll_rad = np.radians(rng.uniform(-options.roll_deg, options.roll_deg))
        on_wall = Pose(walls[wall].site_from_panel.rotation, np.zeros(3))
        at_m = walls[wall].site_from_panel.apply(np.array([*place_m, PROUD_M]))
        pose = pose_facing(on_wall.rotation[:, 2], on_wall.rotation[:, 1], at_m, roll_rad)
        wrong_rgb = _wrong_cells_rgb(int(codes[index]), rng) if index >= options.targets else None
        targets.append(PostedTarget(int(codes[index]), pose, options.u_m, wrong_cells_rgb=wrong_rgb))
    return tuple(targets)


def _places(walls: list[Panel], options: RoomOptions, count: int, rng: np.random.Generator) -> list[tuple[int, Floats]]:
    """Wall and place on it (m, about its middle) of each plate; long walls get more."""
    diagonal_m = np.sqrt(2.0) * (PLATE_SIDE_U + 2 * DEFAULT_PAPER_MARGIN_U) * options.u_m
    poster_m = (np.array(POSTER_SIZE_M) + diagonal_m) / 2
    widths_m = np.array([wall.width_m for wall in walls])
    shares = widths_m[list(options.walls)]
    low_m, high_m = (height_m - options.size_m[2] / 2 for height_m in options.heights_m)
    places: list[tuple[int, Floats]] = []
    for _ in range(POST_TRIES * count):
        if len(places) == count:
            break
        wall = int(rng.choice(options.walls, p=shares / shares.sum()))
        reach_m = (widths_m[wall] - diagonal_m) / 2
        place_m = np.array([rng.uniform(-reach_m, reach_m), rng.uniform(low_m, high_m)])
        near_another = any(at == wall and np.linalg.norm(there - place_m) < diagonal_m for at, there in places)
        if not near_another and not (options.furniture and (np.abs(place_m) < poster_m).all()):
            places.append((wall, place_m))
    if len(places) < count:
        raise ValueError(
            f"the walls have no room for {count} plates of u = {options.u_m} m: post fewer or smaller ones"
        )
    return places


def _wrong_cells_rgb(code: int, rng: np.random.Generator) -> npt.NDArray[np.uint8]:
    """Colours of a plate whose dot E has changed places with a dot off the diagonals."""
    cells_rgb = cell_colours_rgb(code)
    e_cell, other = BASE_CELLS[-1], int(rng.choice(OFF_DIAGONAL_CELLS))
    cells_rgb[[e_cell, other]] = cells_rgb[[other, e_cell]]
    return cells_rgb
