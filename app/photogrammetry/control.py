"""Control and check points of a survey: checked before the adjustment, then matched with the targets that stand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidControlPoints
from app.geometry.control import ControlPoint, Role
from app.photogrammetry.equations import PointEquations
from app.targets.layout import dot_centres_u

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

FEWEST_POINTS = 3  # seven parameters of a similarity take three points of three coordinates


@dataclass(frozen=True)
class StandingTargets:
    """The targets of a network: codes (T,), ascending; which are published, which may carry a point, masks (T,)."""

    codes: Index
    published: Mask
    carrying: Mask


@dataclass(frozen=True)
class MatchedPoints:
    """Points of one role whose targets stand in the network.

    Attributes
    ----------
    points : tuple of ControlPoint
    equations : PointEquations
        The same points, targets numbered as in the network.
    unseen : tuple of ControlPoint
        Points of that role whose target does not stand.
    """

    points: tuple[ControlPoint, ...]
    equations: PointEquations
    unseen: tuple[ControlPoint, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the matched points."""
        return tuple(point.name for point in self.points)


def check_control(points: Sequence[ControlPoint]) -> None:
    """Refuse points that contradict each other as they are written.

    Raises
    ------
    InvalidControlPoints
        When a name or a dot occurs twice, two points share their coordinates, or one or two control points are given.
    """
    _refuse_repeated("the name", points, [point.name for point in points])
    _refuse_repeated("one dot", points, [f"{point.code} {point.dot}" for point in points])
    _refuse_repeated("the same coordinates", points, [str(point.position_m.tolist()) for point in points])
    count = sum(point.role == "control" for point in points)
    if 0 < count < FEWEST_POINTS:
        raise InvalidControlPoints(
            f"{count} control point{' is' if count == 1 else 's are'} too few: the datum takes at least three that are "
            "not in one line, four to find an error in them. Add points, or give none for a map of assumed datum.",
            reason="too-few",
            count=count,
        )


def _refuse_repeated(what: str, points: Sequence[ControlPoint], keys: Sequence[str]) -> None:
    repeated = {key for key, count in Counter(keys).items() if count > 1}
    names = [point.name for point, key in zip(points, keys, strict=True) if key in repeated]
    if names:
        raise InvalidControlPoints(
            f"Control points {', '.join(names)} have {what} in common. Each needs a name, a dot and coordinates of its "
            "own: correct the list.",
            reason="duplicate",
            points=names,
        )


def match_points(points: Sequence[ControlPoint], role: Role, standing: StandingTargets, u_m: float) -> MatchedPoints:
    """Points of one role on targets that stand.

    Parameters
    ----------
    points : sequence of ControlPoint
        All of the survey.
    role : str
    standing : StandingTargets
    u_m : float
        Nominal module of the plates.
    """
    number = {int(code): target for target, code in enumerate(standing.codes) if standing.carrying[target]}
    wanted = [point for point in points if point.role == role]
    matched = tuple(point for point in wanted if point.code in number)
    # The plate's middle is the origin of its frame.
    plane_u = [np.zeros(2) if point.cell is None else dot_centres_u()[point.cell] for point in matched]
    equations = PointEquations(
        np.array([number[point.code] for point in matched], dtype=np.intp),
        np.array(plane_u).reshape(-1, 2) * u_m,
        np.array([point.position_m for point in matched]).reshape(-1, 3),
        np.array([point.sigma_m for point in matched]),
    )
    return MatchedPoints(matched, equations, tuple(point for point in wanted if point.code not in number))


def check_carries_datum(control: MatchedPoints) -> None:
    """Refuse control that does not fix a datum.

    Raises
    ------
    InvalidControlPoints
        When fewer than three control points stand in the network, or all stand in one line.
    """
    unseen = [f"{point.name} (code {point.code})" for point in control.unseen]
    if len(control.points) < FEWEST_POINTS:
        raise InvalidControlPoints(
            f"Only {len(control.points)} of {len(control.points) + len(unseen)} control points are on targets of the "
            f"network; missing: {', '.join(unseen)}. Check their codes, and photograph their plates from three places.",
            reason="not-seen",
            points=[point.name for point in control.unseen],
        )
    if is_one_line(control.equations.position_m, control.equations.sigma_m):
        raise InvalidControlPoints(
            f"Control points {', '.join(control.names)} stand in one line: the map could turn about it. Measure one "
            "more on a plate well off that line.",
            reason="collinear",
            points=list(control.names),
        )


# Breadth across the best line, in standard deviations of a point, below which the turn about that line is unknown:
# thirty leave it uncertain by 2 degrees, with which a map is of no use some metres from the line.
LEAST_BREADTH_SIGMAS = 30.0


def is_one_line(positions_m: Array, sigma_m: Array) -> bool:
    """Whether points of shape (K, 3) fix no turn about their best line."""
    spread_m = np.linalg.svd(positions_m - positions_m.mean(axis=0), compute_uv=False)
    return bool(spread_m[1] < LEAST_BREADTH_SIGMAS * sigma_m.max())
