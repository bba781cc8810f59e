"""The ``control`` of a plan: which dots a surveyor measures, and how well."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.errors import InvalidInput
from app.geometry.control import ControlPoint, Role
from app.planning.plan_fields import Field
from app.planning.plan_file import Plan
from app.planning.scene import PostedTarget
from app.planning.sight import SeenTarget
from app.planning.survey_plan import survey_control
from app.targets.layout import cell_of_dot

CONTROL_FIELDS = ("control", "check", "sigma_mm", "points")
POINT_FIELDS = ("name", "code", "dot", "role")
ROLES = ("control", "check")
USUAL_COUNTS = (4, 8)
USUAL_SIGMA_MM, MM_PER_M = 1.0, 1000.0  # of a total station without a prism, indoors
LEAST_CONTROL = 3  # seven parameters of the datum need three points
LEAST_SIGMA_MM, GREATEST_SIGMA_MM = 0.01, 1000.0
LEAST_RAYS = 3  # a target is published when so many photographs show it
MOST_POINTS = 1_000
SEED_OFFSET = 1_000_003  # the surveyor's noise is not that of the walls

Seen = Sequence[tuple[SeenTarget, ...]]


def rays_of(seen: Seen) -> Counter[int]:
    """How many photographs show each target wholly, by code."""
    return Counter(target.code for photo in seen for target in photo if target.whole and not target.wrong)


def read_control(plan: Plan, seen: Seen, seed: int) -> tuple[ControlPoint, ...]:
    """The points that ``control`` lists, or some far apart on targets that the survey sees often enough.

    Parameters
    ----------
    plan : Plan
    seen : sequence of tuple of SeenTarget
        What each photograph of the survey shows.
    seed : int

    Raises
    ------
    InvalidInput
        Naming line and field, or when the survey shows too few targets.
    """
    section = plan.sections.get("control")
    members = section.members(*CONTROL_FIELDS) if section is not None else {}
    sigma_mm = (
        members["sigma_mm"].number(LEAST_SIGMA_MM, GREATEST_SIGMA_MM) if "sigma_mm" in members else USUAL_SIGMA_MM
    )
    if "points" in members:
        if not {"control", "check"}.isdisjoint(members):
            raise members["points"].error("points are listed, or counted by control and check: leave one out")
        return _listed(members["points"], plan.targets, sigma_mm / MM_PER_M, seed)
    counts = _counts(members)
    rays = rays_of(seen)
    usable = tuple(target for target in plan.targets if rays[target.code] >= LEAST_RAYS)
    wanted = sum(counts) if members else min(sum(counts), len(usable))
    if len(usable) < max(wanted, LEAST_CONTROL):
        problem = (
            f"{max(wanted, LEAST_CONTROL)} points need as many targets that {LEAST_RAYS} photographs of the survey "
            f"show wholly, there are {len(usable)}: take more photographs, or ask for fewer points"
        )
        raise section.error(problem) if section is not None else InvalidInput(problem, field="control")
    return survey_control(usable, (counts[0], wanted - counts[0]), sigma_mm / MM_PER_M, seed + SEED_OFFSET)


def _counts(members: dict[str, Field]) -> tuple[int, int]:
    control, check = USUAL_COUNTS
    if "control" in members:
        control = members["control"].integer(LEAST_CONTROL, MOST_POINTS)
    if "check" in members:
        check = members["check"].integer(0, MOST_POINTS)
    return control, check


def _listed(section: Field, targets: Sequence[PostedTarget], sigma_m: float, seed: int) -> tuple[ControlPoint, ...]:
    rng = np.random.default_rng(seed + SEED_OFFSET)
    by_code = {target.code: target for target in targets}
    points: dict[str, ControlPoint] = {}
    for number, item in enumerate(section.items(), start=1):
        point = _point(item, number, by_code, sigma_m)
        if point.name in points:
            raise item.error(f"there is a point {point.name} already")
        points[point.name] = replace(point, position_m=point.position_m + rng.normal(0.0, sigma_m, 3))
    if sum(point.role == "control" for point in points.values()) < LEAST_CONTROL:
        raise section.error(f"a survey needs at least {LEAST_CONTROL} control points, not in one line")
    return tuple(points.values())


def _point(item: Field, number: int, by_code: dict[int, PostedTarget], sigma_m: float) -> ControlPoint:
    """Without noise."""
    members = item.members(*POINT_FIELDS)
    code = item.needed(members, "code")
    target = by_code.get(code.integer(0, 2**31 - 1))
    if target is None:
        raise code.error(f"there is no target {code.text()} in the plan")
    dot = item.needed(members, "dot")
    try:
        cell = cell_of_dot(dot.text())
    except ValueError as error:
        raise dot.error(str(error)) from error
    name = members["name"].text() if "name" in members else f"P{number}"
    role: Role = "check" if "role" in members and members["role"].one_of(ROLES) == "check" else "control"
    position_m = target.site_from_target.position_m if cell is None else target.dots_m()[cell]
    return ControlPoint(name, target.code, dot.text(), position_m, sigma_m, role)
