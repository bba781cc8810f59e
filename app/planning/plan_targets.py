"""The targets of a plan: listed one by one, or posted by number along walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.planning.plan_fields import Field
from app.planning.plan_walls import Wall
from app.planning.posting import NORTH, UP, pose_facing
from app.planning.scene import DEFAULT_PAPER_MARGIN_U, PostedTarget
from app.targets.choosing import choose_codes
from app.targets.digits import CODE_COUNT
from app.targets.family import CodeFamily
from app.targets.layout import PLATE_SIDE_U

Array = npt.NDArray[np.float64]

TARGET_FIELDS = ("code", "wall", "at_m", "position_m", "normal", "up", "u_mm", "roll_deg")
POST_FIELDS = ("count", "walls", "heights_m", "spread", "seed", "u_mm", "roll_deg")
SPREADS = ("even", "random")
MOST_TARGETS = 100_000
HEIGHTS_M = (1.0, 2.0)  # of the middles of plates that are posted without more words: within reach, over desks
UPRIGHT_COSINE = 0.99  # a normal nearer to the vertical has no upright: north stands for up
POST_TRIES = 50  # per plate, before the walls are called full


@dataclass(frozen=True)
class PostWish:
    """How targets are posted by number.

    Attributes
    ----------
    count : int
    walls : tuple of Wall
        Upright ones.
    heights_m : tuple of float
        Least and greatest height of the plates' middles over the site's origin.
    spread : str
        ``even``: at equal steps along the walls, low and high in turn; ``random``: anywhere, no sheet over another.
    seed : int
        Of random places.
    u_m : float
        Module.
    roll_deg : float
        Random plates hang up to so much askew.
    """

    count: int
    walls: tuple[Wall, ...]
    heights_m: tuple[float, float]
    spread: str
    seed: int
    u_m: float
    roll_deg: float


def read_target(field: Field, walls: dict[str, Wall], u_m: float) -> PostedTarget:
    """One item of ``targets``: on a wall, or anywhere by position and normal.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    members = field.members(*TARGET_FIELDS)
    code = field.needed(members, "code").integer(1, CODE_COUNT - 1)
    u_m = members["u_mm"].positive() / 1000.0 if "u_mm" in members else u_m
    roll_rad = float(np.radians(members["roll_deg"].number())) if "roll_deg" in members else 0.0
    if ("wall" in members) == ("position_m" in members):
        raise field.error("a target stands on a wall (wall, at_m) or anywhere (position_m, normal)")
    if "wall" in members:
        wall = wall_named(members["wall"], walls)
        along_m, up_m = field.needed(members, "at_m").vector(2)
        if not (0 <= along_m <= wall.width_m and 0 <= up_m <= wall.height_m):
            size = f"{wall.width_m:g} x {wall.height_m:g} m"
            raise members["at_m"].error(f"it lies beside the wall {wall.name} of {size}, measured from its lower left")
        axes = wall.site_from_wall.rotation
        pose = pose_facing(axes[:, 2], axes[:, 1], wall.place_m(along_m, up_m), roll_rad)
        return PostedTarget(code, pose, u_m)
    normal = field.needed(members, "normal").vector(3)
    if not np.linalg.norm(normal) > 0:
        raise members["normal"].error("a direction is needed, not the origin")
    up = members["up"].vector(3) if "up" in members else _upright(normal)
    if np.linalg.norm(np.cross(up, normal)) < np.finfo(np.float32).eps * np.linalg.norm(normal):
        raise field.error("up must not lie along the normal")
    return PostedTarget(code, pose_facing(normal, up, members["position_m"].vector(3), roll_rad), u_m)


def read_post(field: Field, walls: dict[str, Wall], u_m: float) -> PostWish:
    """The wish ``post``.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    members = field.members(*POST_FIELDS)
    named = [wall_named(item, walls) for item in members["walls"].items()] if "walls" in members else walls.values()
    upright = tuple(wall for wall in named if abs(wall.site_from_wall.rotation[2, 2]) < 1.0 - UPRIGHT_COSINE)
    if not upright:
        raise field.error("there is no upright wall to post targets on")
    low_m, high_m = HEIGHTS_M
    if "heights_m" in members:
        low_m, high_m = members["heights_m"].vector(2)
    if low_m > high_m:
        raise members["heights_m"].error("the least height comes first")
    return PostWish(
        count=field.needed(members, "count").integer(1, MOST_TARGETS),
        walls=upright,
        heights_m=(float(low_m), float(high_m)),
        spread=members["spread"].one_of(SPREADS) if "spread" in members else "even",
        seed=members["seed"].integer(0, 2**31 - 1) if "seed" in members else 0,
        u_m=members["u_mm"].positive() / 1000.0 if "u_mm" in members else u_m,
        roll_deg=members["roll_deg"].number(0.0, 180.0) if "roll_deg" in members else 0.0,
    )


def post(wish: PostWish, family: CodeFamily, taken: frozenset[int]) -> tuple[PostedTarget, ...]:
    """Targets where the wish has them, with codes that are far apart and not among the taken ones.

    Raises
    ------
    InvalidInput
        When the walls have no room for so many, or the family no codes.
    """
    places = _even_places(wish) if wish.spread == "even" else _random_places(wish)
    targets = []
    for code, (wall, along_m, up_m, roll_rad) in zip(choose_codes(family, wish.count, taken), places, strict=True):
        axes = wall.site_from_wall.rotation
        pose = pose_facing(axes[:, 2], axes[:, 1], wall.place_m(along_m, up_m), roll_rad)
        targets.append(PostedTarget(code, pose, wish.u_m))
    return tuple(targets)


def wall_named(field: Field, walls: dict[str, Wall]) -> Wall:
    """The wall that a field names.

    Raises
    ------
    InvalidInput
        When there is none of that name.
    """
    name = field.text()
    if name not in walls:
        raise field.error(f"there is no wall {name!r}; there are {', '.join(walls) or 'none'}")
    return walls[name]


Place = tuple[Wall, float, float, float]


def _even_places(wish: PostWish) -> list[Place]:
    """At equal steps along all walls in their order, as if they were one."""
    ends_m = np.cumsum([wall.width_m for wall in wish.walls])
    along_m = (np.arange(wish.count) + 0.5) * ends_m[-1] / wish.count
    two_rows = wish.heights_m[1] - wish.heights_m[0] >= _sheet_m(wish.u_m)
    if ends_m[-1] / wish.count * (2 if two_rows else 1) < _sheet_m(wish.u_m):
        raise _full(wish)
    places: list[Place] = []
    for index, at_m in enumerate(along_m):
        which = int(np.searchsorted(ends_m, at_m))
        wall = wish.walls[which]
        reach_m = min(_sheet_m(wish.u_m) / 2, wall.width_m / 2)  # no sheet hangs round a corner
        on_wall_m = float(np.clip(at_m - ends_m[which] + wall.width_m, reach_m, wall.width_m - reach_m))
        places.append((wall, on_wall_m, wish.heights_m[index % 2] - _foot_m(wall), 0.0))
    return places


def _random_places(wish: PostWish) -> list[Place]:
    rng = np.random.default_rng(wish.seed)
    apart_m = np.sqrt(2.0) * _sheet_m(wish.u_m)
    widths_m = np.array([max(wall.width_m - apart_m, 0.0) for wall in wish.walls])
    if not widths_m.any():
        raise _full(wish)
    taken: list[tuple[int, Array]] = []
    places: list[Place] = []
    for _ in range(POST_TRIES * wish.count):
        if len(places) == wish.count:
            return places
        which = int(rng.choice(len(wish.walls), p=widths_m / widths_m.sum()))
        wall = wish.walls[which]
        at_m = np.array([rng.uniform(apart_m / 2, wall.width_m - apart_m / 2), rng.uniform(*wish.heights_m)])
        if all(other != which or np.linalg.norm(there - at_m) >= apart_m for other, there in taken):
            taken.append((which, at_m))
            roll_rad = float(np.radians(rng.uniform(-wish.roll_deg, wish.roll_deg)))
            places.append((wall, float(at_m[0]), float(at_m[1]) - _foot_m(wall), roll_rad))
    if len(places) < wish.count:
        raise _full(wish)
    return places


def _full(wish: PostWish) -> InvalidInput:
    return InvalidInput(
        f"the walls have no room for {wish.count} plates of u = {1000.0 * wish.u_m:g} mm: post fewer or smaller ones"
    )


def _sheet_m(u_m: float) -> float:
    return (PLATE_SIDE_U + 2 * DEFAULT_PAPER_MARGIN_U) * u_m


def _foot_m(wall: Wall) -> float:
    """Height of a wall's lower edge."""
    return float(wall.corners_m()[:, 2].min())


def _upright(normal: Array) -> Array:
    return NORTH if abs(normal[2]) > UPRIGHT_COSINE * np.linalg.norm(normal) else UP
