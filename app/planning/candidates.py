"""Free places on walls where another target could hang."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.geometry.target_map import TargetMap
from app.planning.plan_walls import Wall
from app.planning.posting import pose_facing
from app.planning.scene import DEFAULT_PAPER_MARGIN_U, PostedTarget
from app.targets.choosing import choose_codes
from app.targets.family import family_by_name
from app.targets.layout import PLATE_SIDE_U

Array = npt.NDArray[np.float64]

UPRIGHT = 0.1  # greatest vertical part of an upright wall's normal


@dataclass(frozen=True)
class CandidateOptions:
    """Where candidates hang.

    Attributes
    ----------
    along_m : float
        Between neighbours along a wall.
    heights_m : tuple of float
        Of their middles over the site's origin.
    """

    along_m: float = 1.0
    heights_m: tuple[float, ...] = (1.0, 1.5, 2.0)


@dataclass(frozen=True)
class Candidate:
    """A free place.

    Attributes
    ----------
    wall : str
    at_m : ndarray of shape (2,)
        Along the wall from its left end and up from its lower edge.
    posted : PostedTarget
        A target there, with the next free code.
    """

    wall: str
    at_m: Array
    posted: PostedTarget

    def covers(self, position_m: Array) -> bool:
        """Whether its sheet could lie over one whose middle is at a position."""
        away_m = np.linalg.norm(self.posted.site_from_target.position_m - position_m)
        return bool(away_m < diagonal_m(self.posted.u_m))


def find_candidates(target_map: TargetMap, walls: Sequence[Wall], options: CandidateOptions) -> list[Candidate]:
    """Places on the fronts of upright walls, where nothing hangs.

    Raises
    ------
    InvalidInput
        When there is none, or the family has no code left.
    """
    code = choose_codes(family_by_name(target_map.code_family), 1, target_map.by_code.keys())[0]
    hanging_m = [target.site_from_target.position_m for target in target_map.targets]
    found = []
    for wall in walls:
        axes = wall.site_from_wall.rotation
        for at_m in _places(wall, target_map.u_m, options):
            pose = pose_facing(axes[:, 2], axes[:, 1], wall.place_m(*at_m))
            candidate = Candidate(wall.name, np.array(at_m), PostedTarget(code, pose, target_map.u_m))
            if not any(candidate.covers(position_m) for position_m in hanging_m):
                found.append(candidate)
    if not found:
        raise InvalidInput(
            "no wall has a free place for another target; name upright walls, or other heights", field="suggest"
        )
    return found


def diagonal_m(u_m: float) -> float:
    """Of a sheet of paper: nearer to each other two might overlap."""
    return float(np.sqrt(2.0) * (PLATE_SIDE_U + 2 * DEFAULT_PAPER_MARGIN_U) * u_m)


def _places(wall: Wall, u_m: float, options: CandidateOptions) -> Iterator[tuple[float, float]]:
    """Along and up an upright wall, whole sheets apart from its edges."""
    reach_m = diagonal_m(u_m) / 2.0
    if abs(wall.site_from_wall.rotation[2, 2]) > UPRIGHT or wall.width_m < 2.0 * reach_m:
        return
    foot_m = float(wall.corners_m()[:, 2].min())
    steps = max(int((wall.width_m - 2.0 * reach_m) / options.along_m), 1)
    for along_m in reach_m + (np.arange(steps) + 0.5) * (wall.width_m - 2.0 * reach_m) / steps:
        for height_m in options.heights_m:
            if reach_m <= height_m - foot_m <= wall.height_m - reach_m:
                yield float(along_m), height_m - foot_m
