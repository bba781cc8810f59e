"""A plan: walls, targets, a camera and where to look from, read from YAML or JSON.

One format serves predicted accuracy and synthetic views. Lengths are metres in the site frame (z up) unless their name
says otherwise. ``docs/planning.md`` describes each field.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from app.geometry.camera import CalibratedCamera
from app.planning.plan_camera import default_camera, read_camera
from app.planning.plan_fields import Field, read_fields
from app.planning.plan_targets import MOST_TARGETS, post, read_post, read_target
from app.planning.plan_view import ViewWish, read_view
from app.planning.plan_walls import Wall, read_wall, walls_of_room
from app.planning.scene import PostedTarget
from app.targets.family import FAMILY_NAMES, CodeFamily, family_by_name
from app.targets.layout import DEFAULT_U_M

MM_PER_M = 1000.0

# Read by whoever draws synthetic views; a plan for predicted accuracy may hold them all the same.
OTHER_SECTIONS = ("lights", "imaging", "path", "control", "seed")
FIELDS = ("name", "family", "u_mm", "room_m", "walls", "targets", "post", "camera", "view", *OTHER_SECTIONS)


@dataclass(frozen=True)
class Plan:
    """What stands in a plan.

    Attributes
    ----------
    name : str
    family : CodeFamily
    u_m : float
        Module of plates that say nothing else.
    walls : tuple of Wall
        Names unique.
    targets : tuple of PostedTarget
        Listed ones, then posted ones; codes unique.
    camera : CalibratedCamera
        With the uncertainty that it will have.
    view : ViewWish
        From where the accuracy is wanted, and what is asked of a target in view.
    sections : dict of str to Field
        Those of ``OTHER_SECTIONS`` that the plan has, unread.
    """

    name: str
    family: CodeFamily
    u_m: float
    walls: tuple[Wall, ...]
    targets: tuple[PostedTarget, ...]
    camera: CalibratedCamera
    view: ViewWish
    sections: dict[str, Field] = field(default_factory=dict)


def read_plan(path: Path) -> Plan:
    """Read a plan file.

    Raises
    ------
    InvalidInput
        Naming the line and the field that is wrong, and what is needed.
    """
    return plan_of_fields(read_fields(path), path.stem)


def plan_of_fields(root: Field, name: str) -> Plan:
    """The plan of a file's tree; ``name`` when the plan says none.

    Raises
    ------
    InvalidInput
        As ``read_plan``.
    """
    members = root.members(*FIELDS)
    family = family_by_name(members["family"].one_of(FAMILY_NAMES) if "family" in members else "golay")
    u_m = members["u_mm"].positive() / MM_PER_M if "u_mm" in members else DEFAULT_U_M
    walls = _walls(members)
    by_name = {wall.name: wall for wall in walls}
    return Plan(
        name=members["name"].text() if "name" in members else name,
        family=family,
        u_m=u_m,
        walls=walls,
        targets=_targets(members, by_name, family, u_m),
        camera=read_camera(members["camera"]) if "camera" in members else default_camera(),
        view=read_view(members["view"]) if "view" in members else ViewWish(),
        sections={section: members[section] for section in OTHER_SECTIONS if section in members},
    )


def _walls(members: dict[str, Field]) -> tuple[Wall, ...]:
    walls: dict[str, Wall] = {}
    if "room_m" in members:
        size_m = members["room_m"].vector(3)
        if not (size_m > 0).all():
            raise members["room_m"].error("a room has a positive length, width and height")
        walls = {wall.name: wall for wall in walls_of_room(size_m)}
    for number, item in enumerate(members["walls"].items() if "walls" in members else [], start=1):
        for wall in read_wall(item, number):
            if wall.name in walls:
                raise item.error(f"there is a wall {wall.name} already")
            walls[wall.name] = wall
    return tuple(walls.values())


def _targets(
    members: dict[str, Field], walls: dict[str, Wall], family: CodeFamily, u_m: float
) -> tuple[PostedTarget, ...]:
    targets: dict[int, PostedTarget] = {}
    codes = frozenset(int(code) for code in family.codes)
    for item in members["targets"].items() if "targets" in members else []:
        target = read_target(item, walls, u_m)
        if target.code not in codes:
            raise item.error(f"{target.code} is no code of the family {family.name}")
        if target.code in targets:
            raise item.error(f"there is a target {target.code} already")
        if len(targets) == MOST_TARGETS:
            raise item.error(f"a plan has at most {MOST_TARGETS} targets")
        targets[target.code] = target
    posted = post(read_post(members["post"], walls, u_m), family, frozenset(targets)) if "post" in members else ()
    return (*targets.values(), *posted)
