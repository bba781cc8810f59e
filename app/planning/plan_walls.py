"""The walls of a plan: upright or lying rectangles that carry targets and hide what is behind them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.plan_fields import Field
from app.planning.posting import NORTH, PROUD_M, UP, pose_facing

Array = npt.NDArray[np.float64]
Rgb = tuple[int, int, int]

WALL_FIELDS = ("name", "from_m", "to_m", "height_m", "corners_m", "outline_m", "base_m", "faces", "rgb")
FACES = ("inwards", "outwards")
SQUARE_SHARE = 1e-3  # of a wall's diagonal: how far its corners may be from a rectangle's
BRIGHTEST = 255


@dataclass(frozen=True)
class Wall:
    """A rectangle that carries targets on its front and hides what is behind it, seen from either side.

    Attributes
    ----------
    name : str
    site_from_wall : Pose
        Wall frame: origin in the middle, x right, y up, z out of the front.
    width_m, height_m : float
    rgb : tuple of int or None
        Colour of a synthetic view; None for that of plaster.
    """

    name: str
    site_from_wall: Pose
    width_m: float
    height_m: float
    rgb: Rgb | None = None

    def __post_init__(self) -> None:
        if not (self.width_m > 0 and self.height_m > 0):
            raise ValueError("a wall has a positive width and height")

    def place_m(self, along_m: float, up_m: float) -> Array:
        """Where a sheet hangs, shape (3,): from the lower left corner, seen from the front, and a little proud."""
        return self.site_from_wall.apply(np.array([along_m - self.width_m / 2, up_m - self.height_m / 2, PROUD_M]))

    def corners_m(self) -> Array:
        """Corners in the site frame, shape (4, 3), clockwise from the top left."""
        signs = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]])
        return self.site_from_wall.apply(signs * np.array([self.width_m, self.height_m, 0.0]) / 2)


def walls_of_room(size_m: Array) -> list[Wall]:
    """South, east, north, west, floor and ceiling of a box with a corner at the origin, looking inwards."""
    x, y, z = size_m.tolist()
    ring = np.array([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]])
    sides = _ring(("south", "east", "north", "west"), ring, (0.0, z), None)
    floor = Wall("floor", pose_facing(UP, NORTH, np.array([x / 2, y / 2, 0.0])), x, y)
    ceiling = Wall("ceiling", pose_facing(-UP, NORTH, np.array([x / 2, y / 2, z])), x, y)
    return [*sides, floor, ceiling]


def read_wall(field: Field, number: int) -> list[Wall]:
    """One item of ``walls``: an upright wall on a line, any rectangle by its corners, or an outline of many.

    Raises
    ------
    InvalidInput
        Naming line and field.
    """
    members = field.members(*WALL_FIELDS)
    name = members["name"].text() if "name" in members else f"wall{number}"
    rgb = _rgb(members["rgb"]) if "rgb" in members else None
    if "corners_m" in members:
        return [_of_corners(name, members["corners_m"], rgb)]
    heights_m = _heights(field, members)
    if "outline_m" in members:
        ring = np.array([corner.vector(2) for corner in members["outline_m"].items()]).reshape(-1, 2)
        faces = members["faces"].one_of(FACES) if "faces" in members else "inwards"
        try:
            return walls_of_outline(name, ring, faces, heights_m, rgb)
        except ValueError as error:
            raise members["outline_m"].error(str(error)) from None
    start, end = (field.needed(members, part).vector(2, 3) for part in ("from_m", "to_m"))
    if np.allclose(start[:2], end[:2]):
        raise field.error("from_m and to_m are the same place")
    low = float(start[2]) if len(start) > 2 else heights_m[0]
    return [upright_wall(name, start[:2], end[:2], (low, low + heights_m[1] - heights_m[0]), rgb)]


def _heights(field: Field, members: dict[str, Field]) -> tuple[float, float]:
    base_m = members["base_m"].number() if "base_m" in members else 0.0
    return base_m, base_m + field.needed(members, "height_m").positive()


def _rgb(field: Field) -> Rgb:
    red, green, blue = (item.integer(0, BRIGHTEST) for item in _three(field))
    return red, green, blue


def _three(field: Field) -> list[Field]:
    items = field.items()
    if len(items) != 3:
        raise field.error("three numbers are needed: red, green, blue")
    return items


def upright_wall(
    name: str, left_m: Array, right_m: Array, heights_m: tuple[float, float], rgb: Rgb | None = None
) -> Wall:
    """An upright wall; ``left_m`` and ``right_m`` as who stands before its front sees them."""
    along = np.append(right_m - left_m, 0.0)
    middle = np.append((left_m + right_m) / 2, sum(heights_m) / 2)
    width_m, height_m = float(np.linalg.norm(along)), heights_m[1] - heights_m[0]
    return Wall(name, pose_facing(np.cross(along, UP), UP, middle), width_m, height_m, rgb)


def _of_corners(name: str, field: Field, rgb: Rgb | None) -> Wall:
    corners = field.items()
    if len(corners) != 4:
        raise field.error("four corners are needed: top left, top right, bottom right, bottom left")
    points = np.array([corner.vector(3) for corner in corners])
    right, up = points[1] - points[0], points[0] - points[3]
    diagonal_m = float(np.linalg.norm(points[2] - points[0]))
    skewed_m = np.linalg.norm(points[2] - (points[1] - up))
    sides = float(np.linalg.norm(right)), float(np.linalg.norm(up))
    if min(sides) <= SQUARE_SHARE * diagonal_m:
        raise field.error("the corners enclose nothing")
    if skewed_m > SQUARE_SHARE * diagonal_m or abs(right @ up) > SQUARE_SHARE * diagonal_m * max(sides):
        raise field.error("the corners are no rectangle: cut the wall in rectangles, or give its outline_m")
    return Wall(name, pose_facing(np.cross(right, up), up, points.mean(axis=0)), *sides, rgb)


def walls_of_outline(
    name: str, ring: Array, faces: str, heights_m: tuple[float, float], rgb: Rgb | None = None
) -> list[Wall]:
    """Upright walls along a closed outline of corners (N, 2): ``inwards`` of a room, ``outwards`` of a pillar.

    Raises
    ------
    ValueError
        When the outline encloses nothing.
    """
    if len(ring) < 3:
        raise ValueError("an outline has three corners or more")
    following = np.roll(ring, -1, axis=0)
    if (np.linalg.norm(following - ring, axis=1) == 0).any():
        raise ValueError("two corners that follow each other are the same; the last one leads back to the first")
    area_m2 = float((ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]).sum()) / 2
    if area_m2 == 0:
        raise ValueError("the outline encloses nothing")
    anticlockwise = ring if (area_m2 > 0) == (faces == "inwards") else ring[::-1]
    return _ring([f"{name}.{index + 1}" for index in range(len(ring))], anticlockwise, heights_m, rgb)


def _ring(
    names: list[str] | tuple[str, ...], ring: Array, heights_m: tuple[float, float], rgb: Rgb | None
) -> list[Wall]:
    """Walls along an anticlockwise ring, looking inwards: there the ring runs from right to left."""
    ends = np.roll(ring, -1, axis=0)
    return [upright_wall(name, end, start, heights_m, rgb) for name, start, end in zip(names, ring, ends, strict=True)]
